#pragma once
// A chart is solved once: an equal run of another job is told again instead.

#include "core/pipeline/chart_progress.hpp"
#include "core/pipeline/parameterize_chart.hpp"

namespace unwrapd::pipeline {

/// solver.run(lambda, ...) of the job's chart, held where hold says, begun as the chart says: its
/// solution, or that of an equal run which the disk's core has. The watch is told of the iterations
/// in either case. Throws what Solver::run() throws.
solve::Solution memoized_solve(solve::Solver& solver, const ChartJob& job,
                               const UnwrapOptions& options, double lambda,
                               const ChartProgress& watch);

}  // namespace unwrapd::pipeline
