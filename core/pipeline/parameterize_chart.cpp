#include "core/pipeline/parameterize_chart.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/base/cached.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd::pipeline {
namespace {

struct Run {
  solve::Solution solution;
  std::vector<IterationEvent> events;
};

std::size_t bytes_of(const Run& run) {
  using unwrapd::solve::bytes_of;
  return sizeof(Run) + solve::bytes_of(run.solution.uv) + solve::bytes_of(run.solution.energy) +
         solve::bytes_of(run.events);
}

/// What a run of the solver needs beside its arguments.
struct Running : solve::CacheContext {
  const ChartJob& job;
  const Stop& stop_rule;
  const ChartProgress& progress;
  bool& is_new;
};

/// is_followed: whether iterations are reported; their events are not kept otherwise.
Run run_once(const Running& by, solve::Solver& solver, double lambda,
             [[maybe_unused]] bool is_followed) {
  assert(is_followed == by.progress.is_followed());
  Run made;
  by.is_new = true;
  made.solution =
      solver.run(lambda, by.progress.solve_watch(by.job.disk, by.stop_rule, made.events));
  return made;
}

/// Scales a free map to UV area = 3D area in mesh units, so that all charts share one texel
/// density. A map under position constraints goes to its place on the page.
MappedChart scale_part(const solve::Disk& disk, guarantee::GuaranteedPart part,
                       const solve::ChartConstraints& constraints, const solve::Solution& solution,
                       Executor& executor) {
  MappedChart mapped;
  const double area = measure::area_of(disk.rest);
  const double even = std::sqrt(area / measure::uv_area(disk.rest, disk.faces, part.uv, executor));
  if (!std::isfinite(even))
    throw Error(ErrorCode::solver_failed,
                "a chart collapsed to zero area; choose another method or initial map");
  const solve::PageFrame frame =
      constraints.frame.value_or(solve::PageFrame{Vec2::Zero(), disk.unit * even});
  mapped.uv = frame.to_page(std::move(part.uv), constraints.page);
  mapped.constrained = solve::fixed_vertices(disk.positions.size(), constraints.page);
  mapped.report = {.faces = part.chart->mesh.face_count(),
                   .vertices = part.chart->mesh.vertex_count(),
                   .boundaries = static_cast<Index>(part.chart->loops.size()),
                   .iterations = solution.iterations,
                   .stop_reason = solution.stop_reason,
                   .energy = solution.energy};
  mapped.chart = std::move(part.chart);
  return mapped;
}

}  // namespace

bool is_curve(const UnwrapOptions& options) {
  return options.method == Method::hybrid && !options.lambda_curve.empty();
}

std::vector<double> lambdas_of(const UnwrapOptions& options) {
  return is_curve(options) ? options.lambda_curve : std::vector{options.lambda};
}

bool keeps_order(const UnwrapOptions& options) {
  return is_curve(options) && !options.stop.iterations;
}

std::vector<std::size_t> ascending_order(std::span<const double> lambdas) {
  std::vector<std::size_t> order(lambdas.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return lambdas[k]; });
  return order;
}

solve::ConstrainedStart constrained_start(const charts::Chart& chart, const solve::Disk& disk,
                                          const UnwrapOptions& options,
                                          const solve::ConstrainedStart& constrained) {
  const bool has_start = !chart.start.empty() && options.initial == InitialMap::automatic;
  if (!constrained.constraints.empty() || !has_start) return constrained;
  return {{}, solve::with_unit_area(disk, chart.start)};
}

solve::Solution parameterize_chart(solve::Solver& solver, const ChartJob& job,
                                   const UnwrapOptions& options, double lambda,
                                   const ChartProgress& progress) {
  bool is_new = false;
  const bool may_repeat = job.page.empty() && !shapes_boundary(options);
  const Running by{
      {may_repeat ? job.disk.core : nullptr, progress.stop()}, job, options.stop, progress, is_new};
  const double used_lambda = options.method == Method::hybrid ? lambda : 0;
  const auto found = solve::cached<run_once>(by, solver, used_lambda, progress.is_followed());
  if (!is_new) progress.replay(found->events, options.stop);
  return found->solution;
}

std::vector<MappedChart> scale_parts(const solve::Disk& disk, guarantee::GuaranteedMap guaranteed,
                                     const solve::ChartConstraints& constraints,
                                     const solve::Solution& solution, Executor& executor) {
  std::vector<MappedChart> mapped;
  if (guaranteed.parts.size() == 1) {
    mapped.push_back(
        scale_part(disk, std::move(guaranteed.parts.front()), constraints, solution, executor));
  } else {
    for (guarantee::GuaranteedPart& part : guaranteed.parts) {
      const solve::Disk own = solve::make_disk(part.chart->mesh, part.chart->loops, disk.stop);
      mapped.push_back(scale_part(own, std::move(part), {}, solution, executor));
      mapped.back().report.mending.parts = guaranteed.mending.parts;
    }
  }
  mapped.front().report.mending = guaranteed.mending;
  return mapped;
}

}  // namespace unwrapd::pipeline
