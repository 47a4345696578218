// Which of two starts leads to the lower minimum shows late: energies at the start, and for the
// first ten iterations, tell how good a start is, not where it leads. But starts that lead to
// different minima were only seen where descents are long, and those show soon: after sixteen
// iterations the energy still falls by half a percent or more in eight. There a second descent of
// as many tells the lower minimum, and costs at most half of what one start does. A lead of less
// than kLead is chance. Measured as docs/adr/0004 tells. Rejected: both starts on every mesh,
// or wherever there are holes or flips, which doubles the cost of those that need neither; a longer
// race, which chooses no better; to drop a second descent that is far behind after eight
// iterations, where the best of them still are.
#include "core/solve/arap/accelerate_race.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::solve::arap {
namespace {

constexpr int kPatience = 16;    // iterations of the first descent on its own, then of the second
constexpr int kLately = 8;       // of these
constexpr double kFast = 0.005;  // relative fall in them of a descent that has far to go
constexpr int kMore = 4;         // iterations for both where the second is about to overtake
constexpr double kLead = 0.003;  // of the first one's energy

double energy_after(const Descent& descent, int iterations) {
  const std::vector<double>& energy = descent.solution().energy;
  return energy[std::min(static_cast<std::size_t>(iterations), energy.size() - 1)];
}

/// Whether the first descent, which paused or ended for this reason, is far from its minimum.
bool wants_second(const Race& race, const Descent& first, StopReason reason) {
  if (reason != StopReason::max_iterations) return false;
  if (first.solution().iterations >= race.options.max_iterations) return false;
  return energy_after(first, kPatience - kLately) > (1 + kFast) * first.energy();
}

/// How much lower the second energy is after this many iterations, relative to the first one.
double lead(const Descent& second, const Descent& first, int iterations) {
  return 1 - energy_after(second, iterations) / energy_after(first, iterations);
}

/// Runs the second descent for as many iterations as the first one, and both a little longer where
/// that may change the answer. Returns whether the second shall replace the first.
bool overtakes(const Race& race, Descent& second, Descent& first) {
  const LoopWatch silent{{}, race.watch.stop};
  run(second, {race.options.tolerance, kPatience}, silent);
  const double now = lead(second, first, kPatience);
  const double won = now - lead(second, first, kPatience - kMore);
  const int end = std::min(kPatience + kMore, race.options.max_iterations - 1);  // 1 for the change
  if (now > kLead || now + won <= 0 || end <= kPatience) return now > kLead;
  run(first, {race.options.tolerance, end}, race.watch);
  run(second, {race.options.tolerance, end}, silent);
  return lead(second, first, end) > kLead;
}

Solution go_on(const Race& race, Descent descent) {
  const StopReason reason = run(descent, race.options, race.watch);
  return std::move(descent).finish(reason);
}

}  // namespace

Solution run_race(const Race& race, const UvMap& first,
                  const std::function<const UvMap*()>& second) {
  Descent leader(race.assembly, first, race.rigidity, race.executor);
  const int pause = std::min(kPatience, race.options.max_iterations);
  const StopReason reason = run(leader, {race.options.tolerance, pause}, race.watch);
  const UvMap* other = wants_second(race, leader, reason) ? second() : nullptr;
  if (other == nullptr) return go_on(race, std::move(leader));
  Descent challenger(race.assembly, *other, race.rigidity, race.executor);
  if (!overtakes(race, challenger, leader)) return go_on(race, std::move(leader));
  challenger.take_over(leader.solution());
  if (race.watch.on_iteration) race.watch.on_iteration(challenger.told());
  return go_on(race, std::move(challenger));
}

}  // namespace unwrapd::solve::arap
