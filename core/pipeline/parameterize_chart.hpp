#pragma once
// One chart through the solver: every lambda that is asked for, each map kept to its promise.

#include <memory>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/pipeline/chart_progress.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::pipeline {

/// A chart with its map: a part of the chart that was solved, if the guarantee took a split.
struct MappedChart {
  std::shared_ptr<const charts::Chart> chart;
  UvMap uv;  ///< in mesh units, UV area = 3D area; under position constraints the page's
  std::vector<char> constrained = {};  ///< one a vertex, 1: fixed by a position constraint
  ChartReport report;  ///< of the solve alone: figures of the map are left to the caller
};

/// Whether a map is wanted for each value of a list, which counts for Method::hybrid alone.
bool is_curve(const UnwrapOptions& options);

/// The values of lambda that are asked for: those of the curve, or one.
std::vector<double> lambdas_of(const UnwrapOptions& options);

/// What holds of a chart's map: what is asked for, or what the chart keeps anyway.
Guarantee guarantee_of(const charts::Chart& chart, const UnwrapOptions& options);

/// A chart and its position constraints, in the page's coordinates; empty: it is packed.
struct ChartJob {
  std::shared_ptr<const charts::Chart> chart;
  const solve::Disk& disk;  ///< of that chart
  const solve::VertexConstraints& page;
};

/// For each of lambdas_of(): the chart's parts with their maps. The mesh is analysed and factored
/// once. Throws Error{solver_failed, guarantee_failed, cancelled}.
std::vector<std::vector<MappedChart>> parameterize_chart(const ChartJob& job,
                                                         const UnwrapOptions& options,
                                                         ChartProgress& watch, Executor& executor);

}  // namespace unwrapd::pipeline
