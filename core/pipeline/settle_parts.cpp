#include "core/pipeline/settle_parts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/measure/distortion.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kMuchExcess = 2;       // that of all is 1
constexpr double kUnseenExcess = 1e-3;  // is not worth a solve

measure::DistortionSums sums_of(const MappedChart& part, Executor& executor) {
  return measure::distortion_sums(part.chart->mesh, part.uv, executor);
}

/// D above the ideal, of angles or areas, whichever is more.
double excess_of(const measure::DistortionSums& sums) {
  const Distortion d = measure::distortion(sums);
  return std::max(d.angle, d.area) - 2;
}

/// The part's map after its own solve; none where the guarantee would take it apart.
std::optional<MappedChart> solved(const MappedChart& part, const UnwrapOptions& options,
                                  double lambda, const std::stop_token& stop, Executor& executor) {
  const solve::Disk disk = solve::make_disk(part.chart->mesh, part.chart->loops, stop);
  solve::Solver solver(disk, options, {{}, solve::with_unit_area(disk, part.uv, executor)},
                       executor);
  solve::SolveWatch watch;
  watch.loop.stop = stop;
  solve::Solution solution = solver.run(lambda, watch);
  guarantee::GuaranteeRules rules = guarantee::rules_for(*part.chart, disk, options, lambda);
  rules.intent.executor = &executor;
  rules.intent.global = solver.global();
  guarantee::GuaranteedMap kept = guarantee::keep_guarantee(part.chart, disk, solution.uv, rules);
  if (kept.parts.size() > 1) return std::nullopt;
  MappedChart own = std::move(scale_parts(disk, std::move(kept), {}, solution, executor).front());
  own.report.mending = part.report.mending;  // of the chart that this is a part of
  return own;
}

}  // namespace

void settle_parts(const UnwrapOptions& options, double lambda, const std::stop_token& stop,
                  Executor& executor, std::vector<MappedChart>& parts) {
  if (parts.size() == 1) return;
  std::vector<double> excess;
  measure::DistortionSums all;
  for (const MappedChart& part : parts) {
    const measure::DistortionSums own = sums_of(part, executor);
    excess.push_back(excess_of(own));
    all += own;
  }
  const double much = std::max(kMuchExcess * excess_of(all), kUnseenExcess);
  for (std::size_t k = 0; k < parts.size(); ++k) try {
      if (!(excess[k] > much)) continue;
      std::optional<MappedChart> own = solved(parts[k], options, lambda, stop, executor);
      if (own && excess_of(sums_of(*own, executor)) < excess[k]) parts[k] = std::move(*own);
    } catch (const Error&) {
      throw_if_cancelled(stop);  // it has a map with the guarantee
    }
}

}  // namespace unwrapd::pipeline
