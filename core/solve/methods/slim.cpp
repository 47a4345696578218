// Every iteration solves for the minimum of a convex proxy, reweighted so that its gradient is the
// energy's, and goes there as far as no triangle flips and the energy falls (Armijo). The start is
// the best of three maps, each at its best scale: convex maps never flip on a 3-connected mesh, a
// conformal one is the answer on developable shapes. Holes are closed for the convex maps, which
// would open them as far as they go: a tube starts at an energy of 9.7 instead of 19. Rejected: to
// stop by the length of a step, as is common; it says little of what is left to gain.
#include "core/solve/methods/slim.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/solve/base/cached.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"

namespace unwrapd::solve::methods {
namespace {

constexpr double kShareOfFlip = 0.8;  // of the step at which the first triangle flips
constexpr double kArmijo = 1e-4;      // of the decrease that the gradient promises
constexpr int kMaxStepHalvings = 40;

struct Start {
  UvMap uv;
  double energy;
};

template <class Map>
Start start_from(const Disk& disk, Map map, Executor& executor) {
  try {
    UvMap uv = map();
    uv.resize(disk.positions.size());
    const double scale = best_scale(disk, uv);
    for (Vec2& u : uv) u *= scale;
    const double energy = symmetric_dirichlet_energy(disk, uv, executor);
    return {std::move(uv), energy};
  } catch (const Error&) {  // this map does not exist; try the others
    throw_if_cancelled(disk.stop);
    return {{}, std::numeric_limits<double>::infinity()};
  }
}

Start best_start(const Disk& disk, Executor& executor) {
  const bool has_holes = disk.loops.size() > 1;
  const maps::FilledDisk filled = has_holes ? maps::fill_holes(disk) : maps::FilledDisk();
  const Disk& closed = has_holes ? filled.disk : disk;
  std::array<Start, 3> starts{
      start_from(
          disk, [&] { return maps::mean_value_map(closed); }, executor),
      start_from(
          disk, [&] { return maps::tutte_map(closed); }, executor),
      start_from(
          disk, [&] { return maps::conformal_map(disk, Pins::diameter); }, executor)};
  Start* best = &starts.front();
  for (Start& start : starts)
    if (start.energy < best->energy) best = &start;  // false for NaN
  if (!std::isfinite(best->energy))
    throw Error(ErrorCode::solver_failed,
                "no start map without flipped triangles was found; choose another method or cut "
                "the chart further");
  return std::move(*best);
}

linear::FreeVertices all_but_the_first(const Disk& disk) {
  std::vector<char> fixed(disk.positions.size(), 0);
  fixed.front() = 1;  // translation costs nothing
  return linear::number_free(fixed);
}

class Slim {
 public:
  Slim(const Disk& disk, Start start, Executor& executor)
      : disk_(disk),
        executor_(executor),
        free_(all_but_the_first(disk)),
        system_(disk.faces, free_, disk.stop),
        uv_(std::move(start.uv)),
        energy_(start.energy),
        gradient_(uv_.size()),
        step_(uv_.size(), Vec2::Zero()) {
    check_memory(disk, system_.bytes());
  }

  [[nodiscard]] const UvMap& uv() const { return uv_; }
  [[nodiscard]] double energy() const { return energy_; }

  /// Returns the relative decrease of the energy.
  double iterate() {
    symmetric_dirichlet_gradient(disk_, uv_, gradient_, executor_);
    to_the_minimum_of_the_proxy();
    const double before = energy_;
    search_along_step();
    return (before - energy_) / before;
  }

 private:
  void to_the_minimum_of_the_proxy() {
    system_.clear();
    for (std::size_t t = 0; t < disk_.faces.size(); ++t)
      system_.add(t, proxy_element(
                         disk_.rest[t],
                         measure::jacobian(disk_.rest[t], measure::uv_edges(disk_.faces[t], uv_))));
    if (!system_.factor())
      throw Error(ErrorCode::solver_failed,
                  "a triangle became too thin for double precision; remove needle and zero-area "
                  "triangles and try again");
    std::vector<Vec2> change(static_cast<std::size_t>(free_.count));
    for (std::size_t v = 1; v < uv_.size(); ++v) change[v - 1] = -gradient_[v];
    system_.solve(change);
    std::copy(change.begin(), change.end(), step_.begin() + 1);
  }

  void search_along_step() {
    double slope = 0;
    for (std::size_t v = 0; v < uv_.size(); ++v) slope += gradient_[v].dot(step_[v]);
    double length = std::min(1.0, kShareOfFlip * step_to_flip(disk_, uv_, step_, executor_));
    for (int k = 0; k < kMaxStepHalvings; ++k, length /= 2) {
      UvMap next = uv_;
      for (std::size_t v = 0; v < next.size(); ++v) next[v] += length * step_[v];
      const double energy = symmetric_dirichlet_energy(disk_, next, executor_);
      if (!(energy <= energy_ + kArmijo * length * slope)) continue;
      uv_ = std::move(next);
      energy_ = energy;
      return;
    }
  }

  const Disk& disk_;
  Executor& executor_;
  linear::FreeVertices free_;
  linear::PairSystem system_;
  UvMap uv_;
  double energy_;
  std::vector<Vec2> gradient_;
  std::vector<Vec2> step_;
};

/// Iterates until convergence or a limit, and returns the reason.
StopReason descend(Slim& slim, const Stop& stop, const LoopWatch& watch, Solution& solution) {
  const double tolerance = stop.iterations ? 0 : stop.tolerance;
  const int most = stop.iterations.value_or(stop.max_iterations);
  while (solution.iterations < most) {
    throw_if_cancelled(watch.stop);
    const double fall = slim.iterate();
    solution.uv = slim.uv();
    solution.energy.push_back(slim.energy());
    ++solution.iterations;
    if (watch.on_iteration) watch.on_iteration(solution);
    if (fall <= tolerance) return StopReason::converged;
  }
  return stop.iterations ? StopReason::iterations : StopReason::max_iterations;
}

}  // namespace

Solution slim(const Disk& disk, const Stop& stop, const SolveWatch& watch, Executor& executor) {
  Slim slim(disk, best_start(disk, executor), executor);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  Solution solution{.uv = slim.uv(), .energy = {slim.energy()}};
  solution.stop_reason = descend(slim, stop, watch.loop, solution);
  return solution;
}

}  // namespace unwrapd::solve::methods
