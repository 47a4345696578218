// The methods side by side. ASAP is one direct solve; ARAP is the hybrid of infinite lambda.
//
// A hybrid of very small lambda has nothing to hold it open: with c the conformal energy of the
// ASAP map over its area, a map of uniform scale s costs c s^2 + lambda (s^2 - 1)^2 per area, whose
// only minimum for lambda <= c / 2 is s = 0. There the answer is the limit itself, the ASAP map.
// Two held vertices hold it open.
#include "core/solve/solve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/accelerate.hpp"
#include "core/solve/conformal.hpp"
#include "core/solve/convex_map.hpp"
#include "core/solve/hold_align.hpp"
#include "core/solve/methods.hpp"

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

Rigidity rigidity_of(const Disk& disk, double lambda, LambdaUnits units) {
  if (units == LambdaUnits::dimensionless) return {lambda, false};
  return {lambda / (disk.unit * disk.unit), true};  // Eq. (5) in units of area 1
}

/// The area-weighted mean of lambda_t.
double mean_lambda(const Disk& disk, const Rigidity& rigidity) {
  double sum = 0;
  for (const RestTriangle& rest : disk.rest) sum += rest.area * rigidity.at(rest.area);
  return sum;
}

Solution direct(const Disk& disk, const Holds& holds, UvMap uv) {
  Solution solution{.uv = std::move(uv), .energy = {}, .stop_reason = StopReason::direct};
  solution.energy.push_back(asap_energy(disk.rest, disk.faces, solution.uv) +
                            spring_energy(holds, solution.uv));
  return solution;
}

UvMap map_of_kind(const Disk& disk, InitialMap kind) {
  if (kind == InitialMap::lscm) return conformal_map(disk, Pins::diameter);
  const bool tutte = kind == InitialMap::tutte;
  return scaled_to_unit_area(disk, tutte ? tutte_map(disk) : mean_value_map(disk));
}

/// The start from which a few iterations get farthest: energies at the start tell less.
std::size_t best_of(const std::vector<UvMap>& starts, const Assembly& assembly,
                    const Rigidity& rigidity, Executor& executor) {
  if (starts.size() == 1) return 0;
  const auto energy_after_trial = [&](const UvMap& start) {
    return local_global(assembly, start, {rigidity, kTrialIterations}, {}, executor).energy.back();
  };
  std::vector<double> energy(starts.size());
  std::transform(starts.begin(), starts.end(), energy.begin(), energy_after_trial);
  return static_cast<std::size_t>(std::min_element(energy.begin(), energy.end()) - energy.begin());
}

void tell(const SolveWatch& watch, Stage stage) {
  if (watch.on_stage) watch.on_stage(stage);
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

Solver::Solver(const Disk& disk, const UnwrapOptions& options, Held held, Executor& executor)
    : disk_(disk),
      options_(options),
      holds_(std::move(held.holds)),
      held_start_(std::move(held.start)),
      executor_(executor) {
  assert(held_start_.size() == (holds_.empty() ? 0 : disk.positions.size()));
}

void Solver::move(Held held) {
  assert(is_moved(holds_, held.holds));
  holds_ = std::move(held.holds);
  held_start_ = std::move(held.start);
  starts_.clear();
  conformal_.reset();
}

const std::vector<UvMap>& Solver::starts() {
  if (starts_.empty() && holds_.empty()) starts_ = initial_maps(disk_, options_.initial);
  if (starts_.empty()) starts_ = {held_start_};
  return starts_;
}

UvMap Solver::conformal_under_holds() {
  if (holds_.empty()) return conformal_map(disk_, options_.pins);
  if (holds_.count() == 1) return held_start(conformal_map(disk_, options_.pins), holds_);
  if (!conformal_system_) conformal_system_.emplace(disk_, holds_);
  return conformal_system_->solve(holds_);
}

const UvMap& Solver::conformal() {
  if (!conformal_) conformal_ = conformal_under_holds();
  return *conformal_;
}

Solution Solver::iterate(const Rigidity& rigidity, const std::vector<UvMap>& starts,
                         const SolveWatch& watch) {
  if (!global_) {
    tell(watch, Stage::factor);
    global_.emplace(disk_, holds_);
  }
  tell(watch, Stage::solve);
  const Assembly assembly{disk_, holds_, *global_};
  const UvMap& start = starts[best_of(starts, assembly, rigidity, executor_)];
  const Stop& stop = options_.stop;
  if (stop.iterations)
    return local_global(assembly, start, {rigidity, *stop.iterations}, watch.loop, executor_);
  Descent descent(assembly, start, rigidity, executor_);
  return run_to_convergence(descent, {stop.tolerance, stop.max_iterations}, watch.loop);
}

Solution Solver::hybrid(const Rigidity& rigidity, const SolveWatch& watch) {
  const double lambda = mean_lambda(disk_, rigidity);
  if (lambda > kSafeLambda) return iterate(rigidity, starts(), watch);
  const bool is_held_open = holds_.count() > 1;
  if (lambda <= (is_held_open ? 0 : asap_energy(disk_.rest, disk_.faces, conformal()) / 2))
    return direct(disk_, holds_, conformal());
  if (options_.initial == InitialMap::automatic) return iterate(rigidity, {conformal()}, watch);
  return iterate(rigidity, starts(), watch);
}

Solution Solver::run(double lambda, const SolveWatch& watch) {
  tell(watch, Stage::setup);
  switch (options_.method) {
    case Method::asap:
      tell(watch, Stage::solve);
      return direct(disk_, holds_, conformal());
    case Method::arap:
      return iterate({}, starts(), watch);
    case Method::hybrid:
      return hybrid(rigidity_of(disk_, lambda, options_.lambda_units), watch);
    default:
      return other_method(disk_, options_.method, watch, executor_);
  }
}

}  // namespace unwrapd
