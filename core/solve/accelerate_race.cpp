// Which of two starts leads to the lower minimum shows late: energies at the start, and for the
// first ten iterations, tell how good a start is, not where it leads. But starts that lead to
// different minima were only seen where descents are long, and those show soon: after sixteen
// iterations the energy still falls by half a percent or more in eight. There a second descent of
// sixteen iterations tells the lower minimum, and costs at most half of what one start does.
// Measured on 65 charts (docs/adr/0004). Rejected: both starts on every mesh, or wherever there are
// holes or flips, which nearly doubles the cost of those that need neither; a longer race, which
// chooses no better.
#include "core/solve/accelerate_race.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd {
namespace {

constexpr int kPatience = 16;     // iterations of the first descent on its own, then of the second
constexpr int kLately = 8;        // of these
constexpr double kFast = 0.005;   // relative fall in them of a descent that has far to go
constexpr int kFirstLook = 8;     // iterations after which a second descent is dropped where its
constexpr double kBehind = 1.03;  // energy is more than so many times that of the first

double energy_after(const Descent& descent, int iterations) {
  const std::vector<double>& energy = descent.solution().energy;
  return energy[std::min(static_cast<std::size_t>(iterations), energy.size() - 1)];
}

/// Whether the first descent, which paused or ended for this reason, has far to go.
bool wants_second(const Race& race, const Descent& first, StopReason reason) {
  if (reason != StopReason::max_iterations) return false;
  if (first.solution().iterations >= race.options.max_iterations) return false;
  return energy_after(first, kPatience - kLately) > (1 + kFast) * first.energy();
}

/// Runs the second descent as far as the first one has come. Whether its energy is lower there.
bool overtakes(const Race& race, Descent& second, const Descent& first) {
  const LoopWatch silent{{}, race.watch.stop};
  for (const auto& [iterations, most] : {std::pair{kFirstLook, kBehind}, {kPatience, 1.0}}) {
    run(second, {race.options.tolerance, iterations}, silent);
    if (!(second.energy() < most * energy_after(first, iterations))) return false;
  }
  return true;
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
  if (race.watch.on_iteration) race.watch.on_iteration(challenger.solution());
  return go_on(race, std::move(challenger));
}

}  // namespace unwrapd
