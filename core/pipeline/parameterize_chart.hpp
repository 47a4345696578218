#pragma once
// The steps of one chart that belong to the solver: its start, its solution, and its scale.

#include <memory>
#include <span>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/pipeline/chart_progress.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/solve/constrain_chart.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::pipeline {

/// A chart with its map. The chart is a part of the solved one if the guarantee took a split.
struct MappedChart {
  std::shared_ptr<const charts::Chart> chart;
  UvMap uv;  ///< in mesh units, UV area = 3D area; under position constraints the page's
  std::vector<char> constrained = {};  ///< one a vertex, 1: fixed by a position constraint
  ChartReport report;  ///< of the solve alone: figures of the map are left to the caller
};

/// A chart and its position constraints, in the page's coordinates; empty: it is packed.
struct ChartJob {
  std::shared_ptr<const charts::Chart> chart;
  const solve::Disk& disk;  ///< of that chart
  const solve::VertexConstraints& page;
};

/// Whether a map is wanted for each value of a list, which counts for Method::hybrid alone.
bool is_curve(const UnwrapOptions& options);

/// The values of lambda that are asked for: those of the curve, or one.
std::vector<double> lambdas_of(const UnwrapOptions& options);

/// Whether the maps of a list are kept in order (lambda_order.hpp). Those of a given number of
/// iterations are not: they are for comparison.
bool keeps_order(const UnwrapOptions& options);

/// The indices of the lambdas, smallest first; equal ones keep their order.
std::vector<std::size_t> ascending_order(std::span<const double> lambdas);

/// The constraints of a chart. A chart without any starts from its own map, if it has one.
solve::ConstrainedStart constrained_start(const charts::Chart& chart, const solve::Disk& disk,
                                          const UnwrapOptions& options,
                                          const solve::ConstrainedStart& constrained);

/// Memoizes Solver::run() in the cache that jobs share; replays the progress events of an identical
/// run. Throws what Solver::run() throws.
solve::Solution parameterize_chart(solve::Solver& solver, const ChartJob& job,
                                   const UnwrapOptions& options, double lambda,
                                   const ChartProgress& progress);

/// The parts of a chart, each with its share of the map, scaled to the surface or placed on the
/// page. The report of the first part tells the repairs of the whole chart. Throws
/// Error{solver_failed}.
std::vector<MappedChart> scale_parts(const solve::Disk& disk, guarantee::GuaranteedMap guaranteed,
                                     const solve::ChartConstraints& constraints,
                                     const solve::Solution& solution, Executor& executor);

}  // namespace unwrapd::pipeline
