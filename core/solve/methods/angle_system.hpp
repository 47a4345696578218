#pragma once
// The conditions under which angles fit together in the plane, and the least change of angles that
// meets them to first order: the common core of ABF++ and linear ABF.
//
// There are three kinds of constraints (Sheffer et al. 2005, Eqs. 2-4): a triangle's angles add up
// to pi; those about an inner vertex v to 2 pi (planarity); and the walk about v closes (the
// wheel): the sum of log sin over the angles that follow v in their triangles equals that over the
// angles that precede it. A hole of n corners is a ring like an inner vertex: a walk about it meets
// the fans of all its vertices, whose angles add up to (n + 2) pi. Without this constraint the map
// would rotate and scale around holes, and the layout would have to spread the gap.
//
// With a diagonal Hessian D of the corners, a triangle's own constraint is a projection P of its
// three corners, without multipliers. What remains is B P B' m = r with two unknowns a ring:
// positive definite and with the pattern of the mesh, so that one Cholesky factor suffices. The
// reduction of Sheffer et al. ends in an indefinite system.

#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/pair_system.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::methods {

using FaceAngles = std::array<double, 3>;  ///< at corner i of a face, radians

/// The angles of the disk's rest triangles.
std::vector<FaceAngles> mesh_angles(const Disk& disk);

/// As mesh_angles(), with those about every inner vertex scaled to a sum of 2 pi: the angles from
/// which the result shall deviate as little as possible. All in (0, pi).
std::vector<FaceAngles> target_angles(const Disk& disk);

/// The closed walks that have constraints: around inner vertices and around holes.
struct Rings {
  linear::FreeVertices of;   ///< slot[v]: the ring of vertex v; kFixed on the longest loop
  std::vector<double> turn;  ///< the sum of the angles of each ring: 2 pi, (n + 2) pi
};

Rings make_rings(const Disk& disk);

/// The violation of each constraint; zero for angles that fit together.
struct Misfit {
  std::vector<double> triangle;  ///< sum of angles - pi, one a face
  std::vector<Vec2> ring;        ///< (sum of angles - turn, log of the wheel), one a ring

  /// The greatest absolute entry.
  [[nodiscard]] double largest() const;
};

/// A quadratic model of the energy: sum of curvature d^2 / 2 + slope d over the corners.
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

  /// The change that minimizes the model among those under which the misfit vanishes to first
  /// order. Sets multipliers(). Throws Error{solver_failed}.
  std::vector<FaceAngles> step(std::span<const FaceAngles> angles, const AngleModel& model);

  /// The multipliers (planarity, wheel) of every ring in the last step.
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

/// The mean of (angle / target - 1)^2 over all corners, plus the greatest misfit. At the targets
/// only the misfit counts; at the solution it is zero.
double angle_energy(const AngleSystem& system, std::span<const FaceAngles> angles,
                    std::span<const FaceAngles> target);

/// The map with these angles, all in (0, pi); UV area = 3D area. Throws Error{solver_failed}.
UvMap map_of_angles(const Disk& disk, std::span<const FaceAngles> angles);

}  // namespace unwrapd::solve::methods
