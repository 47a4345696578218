// Selects the method. ASAP is one direct solve; ARAP is the hybrid of infinite lambda.
//
// A hybrid of very small lambda collapses: with c the conformal energy of the ASAP map over its
// area, a map of uniform scale s costs c s^2 + lambda (s^2 - 1)^2 per area, whose only minimum for
// lambda <= c / 2 is s = 0. There the result is the limit itself, the ASAP map. Two constrained
// vertices prevent the collapse. So does a start of less energy than a collapsed map, since no
// iteration raises the energy. The ASAP map is computed only if neither holds.
#include "core/solve/solve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/arap/accelerate_race.hpp"
#include "core/solve/arap/initial_rotations.hpp"
#include "core/solve/base/align_constrained.hpp"
#include "core/solve/base/cached.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/methods.hpp"

namespace unwrapd::solve {
namespace {

/// Above this lambda no useful conformal map has enough energy to collapse the hybrid.
constexpr double kSafeLambda = 0.5;
/// Below this lambda no start is likely to prevent the collapse.
constexpr double kTrustedLambda = 0.02;
/// A start below this share of a collapsed map's energy cannot collapse; the margin is for
/// rounding.
constexpr double kOpenShare = 0.9;
constexpr int kTrialIterations = 2;

arap::Rigidity rigidity_of(const Disk& disk, double lambda, LambdaUnits units) {
  if (units == LambdaUnits::dimensionless) return {lambda, false};
  return {lambda / (disk.unit * disk.unit), true};  // Eq. (5) in units of area 1
}

/// The area-weighted mean of lambda_t.
double mean_lambda(const Disk& disk, const arap::Rigidity& rigidity) {
  double sum = 0;
  for (const measure::RestTriangle& rest : disk.rest) sum += rest.area * rigidity.at(rest.area);
  return sum;
}

/// The energy of a map shrunk to a point: |L|^2 is 0 there, or 1 - 1 / lambda if that is more.
double collapsed_energy(const Disk& disk, const arap::Rigidity& rigidity) {
  double sum = 0;
  for (const measure::RestTriangle& rest : disk.rest) {
    const double lambda = rigidity.at(rest.area);
    sum += rest.area * (lambda > 1 ? 2 - 1 / lambda : lambda);
  }
  return sum;
}

Solution direct(const Disk& disk, const VertexConstraints& constraints, UvMap uv) {
  Solution solution{.uv = std::move(uv), .energy = {}, .stop_reason = StopReason::direct};
  solution.energy.push_back(measure::asap_energy(disk.rest, disk.faces, solution.uv) +
                            soft_constraint_energy(constraints, solution.uv));
  return solution;
}

/// Empty if the rotations contradict each other so much that the map collapses, as around a
/// cylinder. global: the system of the disk without constraints.
std::optional<UvMap> usable_frame_map(const Disk& disk, const arap::GlobalStep& global) {
  constexpr auto kMake = [](const Disk& d, const arap::GlobalStep& of_d) {
    UvMap uv = arap::map_from_rotations(d, of_d);
    const double area = measure::uv_area(d.rest, d.faces, uv, of_d.executor());
    if (!(area > arap::kMinAreaShare)) return UvMap();
    for (Vec2& u : uv) u /= std::sqrt(area);
    return uv;
  };
  UvMap start = cached_of_disk<kMake>(disk, global);
  if (start.empty()) return std::nullopt;
  return start;
}

void tell(const SolveWatch& watch, Stage stage) {
  if (watch.on_stage) watch.on_stage(stage);
}

}  // namespace

UvMap initial_map(const Disk& disk, InitialMap kind, const arap::GlobalStep& global) {
  if (kind == InitialMap::mean_value) return with_unit_area(disk, maps::mean_value_map(disk));
  if (kind == InitialMap::tutte) return with_unit_area(disk, maps::tutte_map(disk));
  if (kind == InitialMap::automatic)
    if (std::optional<UvMap> frames = usable_frame_map(disk, global)) return std::move(*frames);
  return maps::conformal_map(disk, Pins::diameter);
}

Solver::Solver(const Disk& disk, const SolveOptions& options, ConstrainedStart constrained,
               Executor& executor)
    : disk_(disk),
      options_(options),
      holds_(std::move(constrained.constraints)),
      held_start_(std::move(constrained.start)),
      executor_(executor) {
  assert(held_start_.size() == disk.positions.size() || (held_start_.empty() && holds_.empty()));
}

void describe(CacheKey& key, const SolveOptions& options) {
  const auto& [method, lambda_units, initial, pins, stop] = options;
  const auto& [iterations, tolerance, max_iterations] = stop;
  key.add(method).add(lambda_units).add(initial).add(pins);
  key.add(iterations).add(tolerance).add(max_iterations);
}

void describe(CacheKey& key, const Solver& solver) {
  key.add(solver.disk_).add(solver.options_).add(solver.holds_).add(solver.held_start_);
}

void Solver::move(ConstrainedStart constrained) {
  assert(is_moved(holds_, constrained.constraints));
  holds_ = std::move(constrained.constraints);
  held_start_ = std::move(constrained.start);
  start_.reset();
  conformal_.reset();
}

bool Solver::is_automatic() const {
  return options_.initial == InitialMap::automatic && held_start_.empty();
}

const UvMap& Solver::start() {
  if (start_) return *start_;
  if (is_automatic()) start_ = usable_frame_map(disk_, *global_);
  starts_from_frames_ = start_.has_value();
  if (starts_from_frames_) return *start_;
  const bool is_named = options_.initial != InitialMap::automatic;
  const InitialMap kind = is_named ? options_.initial : InitialMap::lscm;
  start_ = held_start_.empty() ? initial_map(disk_, kind, *global_) : held_start_;
  return *start_;
}

/// A conformal map, to search for another minimum from. Null if double precision does not suffice
/// for it, or if options.initial names a start or the first start is that map already.
const UvMap* Solver::second_start() {
  if (!starts_from_frames_) return nullptr;
  if (second_start_) return &*second_start_;
  try {
    second_start_ = maps::exact_conformal_map(disk_);
  } catch (const Error& e) {  // the first start remains
    if (e.code() != ErrorCode::solver_failed) throw;
  }
  return second_start_ ? &*second_start_ : nullptr;
}

UvMap Solver::conformal_under_holds() {
  if (holds_.empty()) return maps::conformal_map(disk_, options_.pins);
  if (holds_.count() == 1)
    return constrained_start(maps::conformal_map(disk_, options_.pins), holds_);
  if (!conformal_system_) conformal_system_.emplace(disk_, holds_);
  return conformal_system_->solve(holds_);
}

const UvMap& Solver::conformal() {
  if (!conformal_) conformal_ = conformal_under_holds();
  return *conformal_;
}

/// Runs exactly options.stop.iterations iterations, from the better of the two starts if there are
/// two.
Solution Solver::iterate_plainly(const arap::Race& race) {
  const auto solution = [&](const UvMap& from, int iterations, const LoopWatch& watch) {
    return arap::local_global(race.assembly, from, {race.rigidity, iterations}, watch, executor_);
  };
  const UvMap* from = &start();
  const UvMap* other = disk_.loops.size() > 1 ? second_start() : nullptr;
  const auto energy_after_trial = [&](const UvMap& map) {
    return solution(map, kTrialIterations, {{}, race.watch.stop}).energy.back();
  };
  if (other != nullptr && energy_after_trial(*other) < energy_after_trial(*from)) from = other;
  return solution(*from, *options_.stop.iterations, race.watch);
}

void Solver::factor(const SolveWatch& watch) {
  if (global_) return;
  tell(watch, Stage::factor);
  global_.emplace(disk_, holds_, &executor_);
}

Solution Solver::iterate(const arap::Rigidity& rigidity, const SolveWatch& watch) {
  factor(watch);
  const UvMap& first = start();
  tell(watch, Stage::solve);
  const Stop& stop = options_.stop;
  const arap::Assembly assembly{disk_, holds_, *global_};
  const arap::Race race{
      assembly, rigidity, {stop.tolerance, stop.max_iterations}, watch.loop, executor_};
  if (stop.iterations) return iterate_plainly(race);
  return arap::run_race(race, first, [&] { return second_start(); });
}

/// Whether the start's energy is so low that no iteration can collapse the map. The hybrid energy
/// of the start is at most its ARAP energy, since ARAP's fits pay nothing for their scale.
bool Solver::stays_open(const arap::Rigidity& rigidity, const SolveWatch& watch) {
  factor(watch);
  return measure::arap_energy(disk_.rest, disk_.faces, start()) <
         kOpenShare * collapsed_energy(disk_, rigidity);
}

Solution Solver::hybrid(const arap::Rigidity& rigidity, const SolveWatch& watch) {
  const double lambda = mean_lambda(disk_, rigidity);
  if (lambda > kSafeLambda) return iterate(rigidity, watch);
  const bool is_held_open = holds_.count() > 1;
  if (holds_.empty() && lambda > kTrustedLambda && stays_open(rigidity, watch))
    return iterate(rigidity, watch);
  if (lambda <= (is_held_open ? 0 : measure::asap_energy(disk_.rest, disk_.faces, conformal()) / 2))
    return direct(disk_, holds_, conformal());
  return iterate(rigidity, watch);
}

Solution Solver::run(double lambda, const SolveWatch& watch) {
  tell(watch, Stage::setup);
  switch (options_.method) {
    case Method::asap:
      tell(watch, Stage::solve);
      return direct(disk_, holds_, conformal());
    case Method::arap:
      return iterate({}, watch);
    case Method::hybrid:
      return hybrid(rigidity_of(disk_, lambda, options_.lambda_units), watch);
    default:
      return other_method(disk_, options_, watch, executor_);
  }
}

Solution Solver::run_from(const UvMap& start, double lambda, int max_iterations) {
  assert(options_.method == Method::hybrid);
  factor({});
  const arap::Rigidity rigidity = rigidity_of(disk_, lambda, options_.lambda_units);
  arap::Descent descent({disk_, holds_, *global_}, start, rigidity, executor_);
  const arap::DescentOptions rule{options_.stop.tolerance, max_iterations};
  const StopReason reason = arap::run(descent, rule, {{}, disk_.stop});
  return std::move(descent).finish(reason);
}

}  // namespace unwrapd::solve
