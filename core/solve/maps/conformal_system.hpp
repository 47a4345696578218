#pragma once
// The matrix of the conformal energy (Sec. 4.2), with vertices held, factored once.

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve::maps {

/// The lower triangle of H + softening L: 4 E(z) = z* H z for the map z = u_x + i u_y, L the
/// cotangent Laplacian.
linear::ComplexMatrix conformal_matrix(const Disk& disk, double softening = 0);

/// As try_factor(), but throws Error{solver_failed} when softening is the most there is to try.
std::unique_ptr<linear::HermitianSystem> try_softened(const linear::ComplexMatrix& lower,
                                                      double softening,
                                                      const linear::MemoryCheck& check,
                                                      const std::stop_token& stop);

/// The softening to try after this one.
double more_softening(double softening);

/// Depends on the mesh, on which vertices are held and on the soft constraints' weights, not on
/// where they are held.
class ConformalSystem {
 public:
  /// At least two vertices are held. Where double precision does not suffice for H, softens it;
  /// throws Error{solver_failed} when that does not help either.
  ConformalSystem(const Disk& disk, const VertexConstraints& constraints);

  /// Nothing where double precision does not suffice for H.
  static std::optional<ConformalSystem> exact(const Disk& disk,
                                              const VertexConstraints& constraints);

  /// The map of least E + sum of weight |u_v - at|^2 over the soft constraints, fixed vertices at
  /// their places. holds: the same vertices and weights as those of the constructor. Thread-safe.
  /// Throws Error{cancelled}, as the disk's job.
  [[nodiscard]] UvMap solve(const VertexConstraints& constraints) const;

 private:
  ConformalSystem() = default;
  bool try_build(const Disk& disk, const VertexConstraints& constraints, double softening,
                 bool may_throw);

  linear::ComplexMatrix lower_;
  linear::FreeVertices free_;
  std::unique_ptr<linear::HermitianSystem> system_;
  std::stop_token stop_;
};

}  // namespace unwrapd::solve::maps
