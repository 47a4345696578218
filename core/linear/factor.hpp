#pragma once
// A symmetric positive definite (or Hermitian) matrix, factored once and solved many times.

#include <complex>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>

#include "core/linear/sparse.hpp"

namespace unwrapd::linear {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::SparseMatrix<Complex, Eigen::ColMajor, Index>;

/// The interface of a factored system.
template <typename Rhs>
class PrefactoredSystem {
 public:
  PrefactoredSystem() = default;
  PrefactoredSystem(const PrefactoredSystem&) = delete;
  PrefactoredSystem& operator=(const PrefactoredSystem&) = delete;
  virtual ~PrefactoredSystem() = default;

  /// Replaces b by the solution of A x = b. Thread-safe. Throws Error{cancelled}; b is then
  /// undefined.
  virtual void solve(std::span<Rhs> b, const std::stop_token& stop = {}) const = 0;
};

/// Two right-hand sides at once: the n-by-2 block of Eq. (4).
using RealSystem = PrefactoredSystem<Vec2>;
using HermitianSystem = PrefactoredSystem<Complex>;

/// Factors the matrix with this lower triangle. Throws Error{solver_failed} if it is not positive
/// definite in double precision, and Error{cancelled}.
std::unique_ptr<RealSystem> factor(const SparseMatrix& lower, const std::stop_token& stop = {});
std::unique_ptr<HermitianSystem> factor(const ComplexMatrix& lower);

/// Called with the bytes of a factor before they are allocated; may throw.
using MemoryCheck = std::function<void(std::size_t bytes)>;

/// As factor(), but returns null if the matrix is not positive definite.
std::unique_ptr<HermitianSystem> try_factor(const ComplexMatrix& lower,
                                            const MemoryCheck& check = {},
                                            const std::stop_token& stop = {});

[[noreturn]] void refuse_indefinite();

/// Throws Error{solver_failed} if the system is null.
template <typename System>
System definite(System system) {
  if (!system) refuse_indefinite();
  return system;
}

/// The real matrix of the real and imaginary parts, rows 2v and 2v + 1: a block [a -b; b a] for
/// each entry a + b i. Both argument and result are lower triangles. Throws Error{cancelled}.
SparseMatrix as_pairs(const ComplexMatrix& lower, const std::stop_token& stop = {});

}  // namespace unwrapd::linear
