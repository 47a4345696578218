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

/// The small interface behind which engines differ.
template <typename Rhs>
class PrefactoredSystem {
 public:
  PrefactoredSystem() = default;
  PrefactoredSystem(const PrefactoredSystem&) = delete;
  PrefactoredSystem& operator=(const PrefactoredSystem&) = delete;
  virtual ~PrefactoredSystem() = default;

  /// Replaces b by the solution of A x = b. Thread-safe. Throws Error{cancelled}: b is then of no
  /// use.
  virtual void solve(std::span<Rhs> b, const std::stop_token& stop = {}) const = 0;
};

/// Two right-hand sides at once: the n-by-2 block of Eq. (4).
using RealSystem = PrefactoredSystem<Vec2>;
using HermitianSystem = PrefactoredSystem<Complex>;

/// Factors the matrix whose lower triangle is given.
/// Throws Error{solver_failed} when it is not positive definite in double precision, and
/// Error{cancelled}.
std::unique_ptr<RealSystem> factor(const SparseMatrix& lower, const std::stop_token& stop = {});
std::unique_ptr<HermitianSystem> factor(const ComplexMatrix& lower);

/// Told how many bytes a factor will take before they are taken; may throw.
using MemoryCheck = std::function<void(std::size_t bytes)>;

/// As factor(), but nothing where that throws.
std::unique_ptr<HermitianSystem> try_factor(const ComplexMatrix& lower,
                                            const MemoryCheck& check = {},
                                            const std::stop_token& stop = {});

[[noreturn]] void refuse_indefinite();

/// Throws Error{solver_failed} when there is no system: its matrix is not positive definite.
template <typename System>
System definite(System system) {
  if (!system) refuse_indefinite();
  return system;
}

/// The real matrix of the real and imaginary parts, rows 2v and 2v + 1: a block [a -b; b a] for
/// each entry a + b i; the lower triangle of what lower is the lower triangle of. Throws
/// Error{cancelled}.
SparseMatrix as_pairs(const ComplexMatrix& lower, const std::stop_token& stop = {});

}  // namespace unwrapd::linear
