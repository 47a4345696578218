#pragma once
// One chart from its disk to its maps: constrain, solve, keep the guarantee, scale; and for a list
// of lambdas, put the maps in order.

#include <vector>

#include "core/pipeline/parameterize_chart.hpp"

namespace unwrapd::pipeline {

/// The maps of one chart: one for each lambda, in several parts where the guarantee took a split.
/// The solver analyses and factors the chart once. Maps of a list that iterate until convergence
/// are in order (lambda_order.hpp). Throws what Solver::run() and keep_guarantee() throw.
std::vector<std::vector<MappedChart>> map_chart(const ChartJob& job, const UnwrapOptions& options,
                                                ChartProgress& progress, Executor& executor);

}  // namespace unwrapd::pipeline
