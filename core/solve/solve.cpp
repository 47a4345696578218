// The methods side by side. ASAP is one direct solve; ARAP is the hybrid of infinite lambda.
//
// A hybrid of very small lambda has nothing to hold it open: with c the conformal energy of the
// ASAP map over its area, a map of uniform scale s costs c s^2 + lambda (s^2 - 1)^2 per area, whose
// only minimum for lambda <= c / 2 is s = 0. There the answer is the limit itself, the ASAP map.
#include "core/solve/solve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/conformal.hpp"
#include "core/solve/convex_map.hpp"

namespace unwrapd {
namespace {

/// Above this lambda no conformal map of use has energy enough to collapse the hybrid.
constexpr double kSafeLambda = 0.5;
constexpr int kTrialIterations = 2;

UvMap scaled_to_unit_area(const Disk& disk, UvMap uv) {
  const double area = uv_area(disk.rest, disk.faces, uv);
  if (area > 0)
    for (Vec2& u : uv) u /= std::sqrt(area);
  return uv;
}

Rigidity rigidity_of(const Disk& disk, const UnwrapOptions& options) {
  if (options.method == Method::arap) return {};
  if (options.lambda_units == LambdaUnits::dimensionless) return {options.lambda, false};
  return {options.lambda / (disk.unit * disk.unit), true};  // Eq. (5) in units of area 1
}

/// The area-weighted mean of lambda_t.
double mean_lambda(const Disk& disk, const Rigidity& rigidity) {
  double sum = 0;
  for (const RestTriangle& rest : disk.rest) sum += rest.area * rigidity.at(rest.area);
  return sum;
}

Solution direct(const Disk& disk, UvMap uv) {
  Solution solution{.uv = std::move(uv), .energy = {}, .stop_reason = StopReason::direct};
  solution.energy.push_back(asap_energy(disk.rest, disk.faces, solution.uv));
  return solution;
}

UvMap map_of_kind(const Disk& disk, InitialMap kind) {
  if (kind == InitialMap::lscm) return conformal_map(disk, Pins::diameter);
  const bool tutte = kind == InitialMap::tutte;
  return scaled_to_unit_area(disk, tutte ? tutte_map(disk) : mean_value_map(disk));
}

/// The start from which a few iterations get farthest: energies at the start tell less.
std::size_t best_of(const std::vector<UvMap>& starts, const GlobalStep& global,
                    const Rigidity& rigidity, Executor& executor) {
  const auto energy_after_trial = [&](const UvMap& start) {
    return local_global(global, start, {rigidity, kTrialIterations}, {}, executor).energy.back();
  };
  std::vector<double> energy(starts.size());
  std::transform(starts.begin(), starts.end(), energy.begin(), energy_after_trial);
  return static_cast<std::size_t>(std::min_element(energy.begin(), energy.end()) - energy.begin());
}

Solution iterate(const Disk& disk, const UnwrapOptions& options, std::vector<UvMap> starts,
                 const SolveWatch& watch, Executor& executor) {
  if (watch.on_stage) watch.on_stage(Stage::factor);
  const GlobalStep global(disk);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  const Rigidity rigidity = rigidity_of(disk, options);
  const std::size_t best = starts.size() > 1 ? best_of(starts, global, rigidity, executor) : 0;
  return local_global(global, std::move(starts[best]), {rigidity, options.iterations}, watch.loop,
                      executor);
}

}  // namespace

std::vector<UvMap> initial_maps(const Disk& disk, InitialMap kind) {
  if (kind != InitialMap::automatic) return {map_of_kind(disk, kind)};
  if (disk.loops.size() > 1) return {map_of_kind(disk, InitialMap::lscm)};
  std::vector<UvMap> maps{map_of_kind(disk, InitialMap::mean_value)};
  if (std::optional<UvMap> conformal = exact_conformal_map(disk))
    maps.push_back(std::move(*conformal));
  return maps;
}

Solution solve(const Disk& disk, const UnwrapOptions& options, const SolveWatch& watch,
               Executor& executor) {
  if (watch.on_stage) watch.on_stage(Stage::setup);
  if (options.method == Method::asap) {
    if (watch.on_stage) watch.on_stage(Stage::solve);
    return direct(disk, conformal_map(disk, options.pins));
  }
  const double lambda = mean_lambda(disk, rigidity_of(disk, options));
  if (lambda > kSafeLambda)
    return iterate(disk, options, initial_maps(disk, options.initial), watch, executor);

  UvMap conformal = conformal_map(disk, options.pins);
  if (lambda <= asap_energy(disk.rest, disk.faces, conformal) / 2)
    return direct(disk, std::move(conformal));
  std::vector<UvMap> starts;
  if (options.initial == InitialMap::automatic)
    starts.push_back(std::move(conformal));
  else
    starts = initial_maps(disk, options.initial);
  return iterate(disk, options, std::move(starts), watch, executor);
}

}  // namespace unwrapd
