#pragma once
// What angles must meet to lie flat, and the least change of angles that meets it to first order:
// the common core of ABF++ and linear ABF.
//
// Three kinds of constraints (Sheffer et al. 2005, Eqs. 2-4): a triangle's angles add up to pi;
// those about an inner vertex v to 2 pi (planarity); and the sides met on a walk about v close up
// (the wheel): the sum of log sin over the angles that follow v in their triangles equals that over
// the angles that precede it. A hole of n corners is a ring like an inner vertex: a walk about it
// meets the fans of all its vertices, whose angles add up to (n + 2) pi. Without that the map would
// turn and grow around holes, which a layout can only smear.
//
// With a diagonal Hessian D of the corners, a triangle's own constraint is a projection P of its
// three corners, without multipliers. What is left is B P B' m = r with two unknowns a
// ring: positive definite and with the pattern of the mesh, so that one Cholesky factor serves,
// where the reduction of Sheffer et al. ends in an indefinite one.

#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/pair_system.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::methods {

using FaceAngles = std::array<double, 3>;  ///< at corner i of a face, radians

/// The mesh's own angles, of its rest triangles.
std::vector<FaceAngles> mesh_angles(const Disk& disk);

/// As mesh_angles(), those about every inner vertex scaled to a sum of 2 pi: what angles shall
/// deviate from as little as possible. All in (0, pi).
std::vector<FaceAngles> target_angles(const Disk& disk);

/// What a walk can be made about: inner vertices and holes.
struct Rings {
  linear::FreeVertices of;   ///< slot[v]: the ring of vertex v; kFixed on the longest loop
  std::vector<double> turn;  ///< what the angles of each ring must add up to; 2 pi, (n + 2) pi
};

Rings make_rings(const Disk& disk);

/// How far angles are from lying flat; all zero when they do.
struct Misfit {
  std::vector<double> triangle;  ///< sum of angles - pi, one a face
  std::vector<Vec2> ring;        ///< (sum of angles - turn, log of the wheel), one a ring

  /// The greatest of all, absolute.
  [[nodiscard]] double largest() const;
};

/// A quadratic model of what shall be least: sum of curvature d^2 / 2 + slope d over the corners.
struct AngleModel {
  std::vector<FaceAngles> slope;
  std::vector<FaceAngles> curvature;  ///< > 0
};

class AngleSystem {
 public:
  /// disk and executor must outlive the system.
  AngleSystem(const Disk& disk, Executor& executor);

  [[nodiscard]] const Rings& rings() const { return rings_; }

  [[nodiscard]] Misfit misfit(std::span<const FaceAngles> angles) const;

  /// The change of least model under which the misfit vanishes to first order. Leaves the
  /// multipliers of the rings' constraints in multipliers(). Throws Error{solver_failed}.
  std::vector<FaceAngles> step(std::span<const FaceAngles> angles, const AngleModel& model);

  /// (planarity, wheel) of every ring, of the last step.
  [[nodiscard]] std::span<const Vec2> multipliers() const { return multipliers_; }

 private:
  struct FaceBlock;
  [[nodiscard]] std::vector<FaceBlock> blocks(std::span<const FaceAngles> angles,
                                              const AngleModel& model) const;
  void factor(std::span<const FaceBlock> blocks);

  const Disk& disk_;
  Executor& executor_;
  Rings rings_;
  std::optional<linear::PairSystem> system_;
  std::vector<Vec2> multipliers_;
};

/// The mean of (angle / target - 1)^2 over all corners, plus the greatest misfit: the latter is all
/// of it where angles are the targets, and nothing of it in the end.
double angle_energy(const AngleSystem& system, std::span<const FaceAngles> angles,
                    std::span<const FaceAngles> target);

/// The map that these angles, all in (0, pi), give; UV area = 3D area. Throws Error{solver_failed}.
UvMap map_of_angles(const Disk& disk, std::span<const FaceAngles> angles);

}  // namespace unwrapd::solve::methods
