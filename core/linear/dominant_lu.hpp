#pragma once
// An LU factorization for matrices that need no pivoting: diagonally dominant ones of symmetric
// pattern, such as those of convex combination maps.

#include <span>
#include <stop_token>
#include <vector>

#include "core/linear/sparse.hpp"

namespace unwrapd::linear {

/// Solves A x = b for both coordinates of b at once; b becomes x. matrix: square, row i diagonally
/// dominant, pattern symmetric (values need not be). Throws Error{solver_failed} if a pivot
/// vanishes, and Error{cancelled}. The same bits on any processor.
void solve_dominant(const SparseMatrix& matrix, std::span<Vec2> b,
                    const std::stop_token& stop = {});

/// The same with the registers of the x86-64 baseline, for comparison.
void solve_dominant_on_baseline(const SparseMatrix& matrix, std::span<Vec2> b);

}  // namespace unwrapd::linear
