#pragma once
// The numbers of a Cholesky factor, by the multifrontal method.

#include "core/base/executor.hpp"
#include "core/linear/analysis.hpp"

namespace unwrapd::linear {

/// Factors the matrix, of the pattern analysed, whose lower triangle's values are given. panels:
/// room for analysis.panel_begin.back() numbers, the same bits for any executor. False when the
/// matrix is not positive definite in double precision; the panels are of no use then.
[[nodiscard]] bool factor_multifrontal(const Analysis& analysis, const double* values,
                                       double* panels, Executor& executor);

}  // namespace unwrapd::linear
