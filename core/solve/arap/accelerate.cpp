// The plain iteration is a gradient descent with step 1 in the metric of its matrix A, and crawls
// where the triangles' rotations must travel far. L-BFGS (Nocedal 1980) with A^-1 for its first
// Hessian needs the same solve and one evaluation an iteration (docs/adr/0010 has the figures of
// Nesterov's and Anderson's ways). As A bounds the curvature from above, the plain step never
// raises the energy: it is what is left when no step along the direction lowers it enough.
#include "core/solve/arap/accelerate.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::solve::arap {
namespace {

constexpr double kSufficient = 1e-4;  // Armijo: this share of the fall that the slope promises
constexpr int kHalvings = 3;

}  // namespace

Descent::Descent(const Assembly& assembly, const UvMap& start, const Rigidity& rigidity,
                 Executor& executor)
    : global_(assembly.global),
      objective_(assembly.disk, rigidity, assembly.constraints, global_.rank(), executor),
      memory_(executor),
      uv_(by_rank(start, global_.rank())),
      trial_(uv_.size()) {
  const std::size_t n = trial_.size();
  for (auto* vector : {&now_.force, &now_.plain, &before_.force, &before_.plain, &step_,
                       &direction_, &force_at_trial_})
    vector->resize(n);
  solution_.energy.push_back(objective_.evaluate(uv_, now_.force));
  if (std::isfinite(rigidity.lambda)) least_area_ = kMinAreaShare * objective_.uv_area();
}

double Descent::try_step(double length, std::span<const Vec2> direction) {
  for (std::size_t v = 0; v < trial_.size(); ++v) trial_[v] = uv_[v] + length * direction[v];
  const double energy = objective_.evaluate(trial_, force_at_trial_);
  if (!(objective_.uv_area() < least_area_)) return energy;
  solution_.stop_reason = StopReason::collapse_guard;
  return std::numeric_limits<double>::infinity();
}

bool Descent::advance(double slope, std::span<const Vec2> direction) {
  if (!(slope > 0)) return false;
  double length = 1;
  for (int k = 0; k <= kHalvings; ++k, length /= 2) {
    const double energy = try_step(length, direction);
    if (!(energy <= this->energy() - kSufficient * length * slope)) continue;
    for (std::size_t v = 0; v < trial_.size(); ++v) step_[v] = trial_[v] - uv_[v];
    std::swap(now_, before_);
    std::swap(now_.force, force_at_trial_);
    std::swap(uv_, trial_);
    solution_.energy.push_back(energy);
    ++solution_.iterations;
    has_stepped_ = true;
    return true;
  }
  return false;
}

bool Descent::step() {
  solution_.stop_reason = StopReason::converged;
  now_.plain = now_.force;
  global_.solve_by_rank(now_.plain);
  if (std::exchange(has_stepped_, false)) memory_.learn(step_, before_, now_);
  const bool is_plain = memory_.empty();
  if (advance(memory_.direct(now_, direction_), direction_)) return true;
  if (is_plain) return false;
  memory_.forget();
  solution_.stop_reason = StopReason::converged;
  return advance(memory_.direct(now_, direction_), direction_);
}

bool Descent::has_converged(double tolerance) const {
  const std::vector<double>& energy = solution_.energy;
  if (energy.back() <= kNothing) return true;
  return energy.size() > kWindow &&
         energy[energy.size() - 1 - kWindow] - energy.back() <= tolerance * energy.back();
}

void Descent::take_over(const Solution& before) {
  const double own = energy();
  assert(own <= before.energy.back());
  solution_.energy = before.energy;
  solution_.energy.push_back(own);
  solution_.iterations = before.iterations + 1;
}

const Solution& Descent::told() {
  solution_.uv = by_vertex(uv_, global_.rank());
  return solution_;
}

Solution Descent::finish(StopReason reason) && {
  told();
  solution_.stop_reason = reason;
  return std::move(solution_);
}

StopReason run(Descent& descent, const DescentOptions& options, const LoopWatch& watch) {
  while (!descent.has_converged(options.tolerance)) {
    throw_if_cancelled(watch.stop);
    if (descent.solution().iterations >= options.max_iterations) return StopReason::max_iterations;
    if (!descent.step()) return descent.solution().stop_reason;
    if (watch.on_iteration) watch.on_iteration(descent.told());
  }
  return StopReason::converged;
}

}  // namespace unwrapd::solve::arap
