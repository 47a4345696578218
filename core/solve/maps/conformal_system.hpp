#pragma once
// The matrix of the conformal energy (Sec. 4.2) under constraints, factored once.

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

/// As try_factor(), but throws Error{solver_failed} if softening is already the maximum.
std::unique_ptr<linear::HermitianSystem> try_softened(const linear::ComplexMatrix& lower,
                                                      double softening,
                                                      const linear::MemoryCheck& check,
                                                      const std::stop_token& stop);

/// The next softening to try.
double more_softening(double softening);

/// Depends on the mesh, on which vertices are constrained and on the soft constraints' weights, but
/// not on the positions of the constraints.
class ConformalSystem {
 public:
  /// Needs at least two constraints. Softens H if double precision does not suffice for it. Throws
  /// Error{solver_failed} if that does not help.
  ConformalSystem(const Disk& disk, const VertexConstraints& constraints);

  /// Empty if double precision does not suffice for H.
  static std::optional<ConformalSystem> exact(const Disk& disk,
                                              const VertexConstraints& constraints);

  /// The map that minimizes E + sum of weight |u_v - at|^2 over the soft constraints, under the
  /// hard ones. constraints: the same vertices and weights as in the constructor. Thread-safe.
  /// Throws Error{cancelled} when the disk's job is cancelled.
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
