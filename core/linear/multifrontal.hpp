#pragma once
// Computes the numbers of a Cholesky factor by the multifrontal method.

#include "core/base/executor.hpp"
#include "core/linear/analysis.hpp"

namespace unwrapd::linear {

/// Factors the matrix of the analysed pattern with these values of its lower triangle. panels:
/// memory for analysis.panel_begin.back() numbers; the same bits for any executor. Returns false if
/// the matrix is not positive definite in double precision; the panels are then undefined.
[[nodiscard]] bool factor_multifrontal(const Analysis& analysis, const double* values,
                                       double* panels, Executor& executor);

}  // namespace unwrapd::linear
