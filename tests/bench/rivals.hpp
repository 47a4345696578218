#pragma once
// Sparse Cholesky factors side by side: ours, Eigen's, and CHOLMOD's where it is installed (built
// with UNWRAPD_HAS_CHOLMOD; Debian's library contains GPL modules, so that no product links it).

#include <Eigen/SparseCore>

#include <functional>
#include <optional>
#include <vector>

#include "core/linear/factor.hpp"

namespace unwrapd::bench {

/// Milliseconds of the processor for each phase, one thread.
struct Times {
  double analysis = 0, factor = 0, refactor = 0, solve = 0, megabytes = 0;

  [[nodiscard]] double ten_iterations() const { return analysis + factor + 10 * solve; }
};

/// What a matrix is solved for: two right-hand sides, or one of pairs of unknowns.
enum class Unknowns { single, pairs };

Times time_ours(const linear::SparseMatrix& lower, Unknowns unknowns);
Times time_eigen(const linear::SparseMatrix& lower, Unknowns unknowns);

/// As complex matrices were factored before pairs were.
Times time_eigen(const linear::ComplexMatrix& lower);

/// Supernodal, with AMD; nothing where it is not there.
std::optional<Times> time_cholmod(const linear::SparseMatrix& lower, Unknowns unknowns);

}  // namespace unwrapd::bench
