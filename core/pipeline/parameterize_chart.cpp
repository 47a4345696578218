#include "core/pipeline/parameterize_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/measure/distortion.hpp"
#include "core/pipeline/memoized_solve.hpp"
#include "core/solve/constrain_chart.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kMindsSizes = 0.01;  // lambda
constexpr double kMostRise = 0.5;     // of a segmented chart's energy, rather than a split

/// The energy that keeping a promise shall raise as little as it can: the method's own. Methods
/// that draw a map from angles or scales have that of angles.
solve::arap::Rigidity rigidity_of(const solve::Disk& disk, const UnwrapOptions& options,
                                  double lambda) {
  switch (options.method) {
    case Method::arap:
    case Method::slim:
      return {};
    case Method::hybrid:
      if (options.lambda_units == LambdaUnits::dimensionless) return {lambda, false};
      return {lambda / (disk.unit * disk.unit), true};
    default:
      return {0, false};
  }
}

/// What a map that replaces the method's shall keep of it. A hybrid that hardly minds sizes counts
/// as a method of angles: its energy alone would have the map shrink.
solve::repair::OwnEnergy own_energy_of(const solve::Disk& disk, const UnwrapOptions& options,
                                       const solve::arap::Rigidity& rigidity) {
  if (options.method == Method::slim) return solve::repair::OwnEnergy::symmetric_dirichlet;
  if (options.method == Method::arap) return solve::repair::OwnEnergy::fit;
  const double mean_area = 1.0 / static_cast<double>(disk.faces.size());
  const bool minds_sizes =
      options.method == Method::hybrid && rigidity.at(mean_area) >= kMindsSizes;
  return minds_sizes ? solve::repair::OwnEnergy::fit : solve::repair::OwnEnergy::mips;
}

/// What is held, and where nothing is, the map that the chart came with to begin with.
solve::ConstrainedStart constrained_or_begun(const charts::Chart& chart, const solve::Disk& disk,
                                             const UnwrapOptions& options,
                                             const solve::ConstrainedStart& constrained) {
  const bool has_start = !chart.start.empty() && options.initial == InitialMap::automatic;
  if (!constrained.constraints.empty() || !has_start) return constrained;
  solve::ConstrainedStart begun{{}, chart.start};
  const double area = measure::uv_area(disk.rest, disk.faces, begun.start);
  for (Vec2& u : begun.start) u /= std::sqrt(area);
  return begun;
}

/// Scales a free map to UV area = 3D area in mesh units: all charts then share one texel density.
/// One under position constraints goes to its place on the page.
MappedChart finish(const solve::Disk& disk, guarantee::GuaranteedPart part,
                   const solve::ChartConstraints& hold, const solve::Solution& solution,
                   Executor& executor) {
  MappedChart mapped;
  double area = 0;
  for (const measure::RestTriangle& rest : disk.rest) area += rest.area;
  const double even = std::sqrt(area / measure::uv_area(disk.rest, disk.faces, part.uv, executor));
  if (!std::isfinite(even))
    throw Error(ErrorCode::solver_failed,
                "a chart collapsed to zero area; choose another method or initial map");
  const solve::PageFrame frame =
      hold.frame.value_or(solve::PageFrame{Vec2::Zero(), disk.unit * even});
  mapped.uv = frame.to_page(std::move(part.uv), hold.page);
  mapped.constrained = solve::fixed_vertices(disk.positions.size(), hold.page);
  mapped.report = {.faces = part.chart->mesh.face_count(),
                   .vertices = part.chart->mesh.vertex_count(),
                   .boundaries = static_cast<Index>(part.chart->loops.size()),
                   .iterations = solution.iterations,
                   .stop_reason = solution.stop_reason,
                   .energy = solution.energy};
  mapped.chart = std::move(part.chart);
  return mapped;
}

/// The parts that keep the promise, each with its share of the map. What mending took is told with
/// the first of them.
std::vector<MappedChart> finish_parts(const solve::Disk& disk, guarantee::GuaranteedMap kept,
                                      const solve::ChartConstraints& hold,
                                      const solve::Solution& solution, Executor& executor) {
  std::vector<MappedChart> mapped;
  if (kept.parts.size() == 1) {
    mapped.push_back(finish(disk, std::move(kept.parts.front()), hold, solution, executor));
  } else {
    for (guarantee::GuaranteedPart& part : kept.parts) {
      const solve::Disk own = solve::make_disk(part.chart->mesh, part.chart->loops, disk.stop);
      mapped.push_back(finish(own, std::move(part), {}, solution, executor));
      mapped.back().report.mending.parts = kept.mending.parts;
    }
  }
  mapped.front().report.mending = kept.mending;
  return mapped;
}

/// Charts that were segmented are many already, and shall be little distorted.
double most_rise_of(const charts::Chart& chart) {
  return chart.least == Guarantee::bijective ? kMostRise : std::numeric_limits<double>::infinity();
}

}  // namespace

Guarantee guarantee_of(const charts::Chart& chart, const UnwrapOptions& options) {
  if (options.guarantee == Guarantee::none) return Guarantee::none;
  return std::max(options.guarantee, chart.least);
}

bool is_curve(const UnwrapOptions& options) {
  return options.method == Method::hybrid && !options.lambda_curve.empty();
}

std::vector<double> lambdas_of(const UnwrapOptions& options) {
  return is_curve(options) ? options.lambda_curve : std::vector{options.lambda};
}

std::vector<std::vector<MappedChart>> parameterize_chart(const ChartJob& job,
                                                         const UnwrapOptions& options,
                                                         ChartProgress& watch, Executor& executor) {
  const charts::Chart& chart = *job.chart;
  solve::Disk disk = job.disk;  // which other jobs may have, too
  disk.stop = watch.stop();
  const std::vector<double> lambdas = lambdas_of(options);
  watch.begin_chart(chart.mesh.faces.size(), lambdas.size());
  throw_if_cancelled(watch.stop());
  const solve::ChartConstraints hold =
      solve::constrain_chart(disk, options, job.page, watch.stop(), executor);
  solve::Solver solver(disk, options, constrained_or_begun(chart, disk, options, hold.constrained),
                       executor);
  std::vector<std::vector<MappedChart>> maps(lambdas.size());
  for (std::size_t k = 0; k < lambdas.size(); ++k) {
    watch.begin_run(is_curve(options) ? std::optional(lambdas[k]) : std::nullopt);
    solve::Solution solution = memoized_solve(solver, job, options, lambdas[k], watch);
    const solve::arap::Rigidity rigidity = rigidity_of(disk, options, lambdas[k]);
    const guarantee::GuaranteeRules rules{
        guarantee_of(chart, options),
        options.repair,
        {.rigidity = rigidity,
         .constrained = solve::fixed_vertices(disk.positions.size(), hold.constrained.constraints),
         .stop = watch.stop(),
         .own = own_energy_of(disk, options, rigidity),
         .soft = hold.constrained.constraints.soft,
         .executor = &executor,
         .global = solver.global()},
        most_rise_of(chart)};
    if (options.guarantee != Guarantee::none) watch.tell(Stage::untangle);
    guarantee::GuaranteedMap kept =
        guarantee::keep_guarantee(job.chart, disk, std::move(solution.uv), rules);
    maps[k] = finish_parts(disk, std::move(kept), hold, solution, executor);
    watch.end_run();
  }
  watch.end_chart();
  return maps;
}

}  // namespace unwrapd::pipeline
