// Which of two starts leads to the lower minimum shows late: energies at the start, and for the
// first ten iterations, tell how good a start is, not where it leads. But starts that lead to
// different minima were only seen where descents are long, and there a second one of 40 iterations
// costs little. Flips in a start are no such sign: a flip-free one gets the same flips within five
// iterations, but for a few meshes, of fast descents again. Measured on 52 charts (docs/adr/0004).
// Rejected: both starts on every mesh, which doubles the cost of those that need neither.
#include "core/solve/accelerate_race.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/measure/distortion.hpp"

namespace unwrapd {
namespace {

constexpr int kPatience = 40;             // iterations of the first descent on its own
constexpr int kPatienceAroundHoles = 24;  // the same with several boundaries
constexpr double kFewFlips = 0.01;        // of all triangles: more of them are no accident

/// The second descent is dropped where its energy is more than so many times that of the first
/// after as many iterations.
struct Bout {
  int iterations;
  double most;
};
constexpr std::array<Bout, 3> kBouts{{{8, 1.03}, {16, 1.01}, {24, 1}}};

bool has_holes(const Race& race) { return race.assembly.disk.loops.size() > 1; }

/// Leaves one iteration for the change to a second start, which counts as one: around holes always,
/// so that one is tried however few iterations there are.
int patience(const Race& race) {
  const int most = race.options.max_iterations;
  return has_holes(race) ? std::min(kPatienceAroundHoles, most - 1) : std::min(kPatience, most);
}

double energy_after(const Descent& descent, int iterations) {
  const std::vector<double>& energy = descent.solution().energy;
  return energy[std::min(static_cast<std::size_t>(iterations), energy.size() - 1)];
}

/// Why to try a second start, after the first descent ended for this reason or used its patience
/// up.
std::optional<SecondStart> reason_for_second(const Race& race, const Descent& first,
                                             StopReason reason) {
  if (first.energy() <= Descent::kNothing) return std::nullopt;
  if (first.solution().iterations >= race.options.max_iterations) return std::nullopt;
  if (has_holes(race) || reason == StopReason::max_iterations) return SecondStart::other_minimum;
  const Disk& disk = race.assembly.disk;
  const Index flips = distortion_sums(disk.rest, disk.faces, first.solution().uv).flipped;
  const double share = static_cast<double>(flips) / static_cast<double>(disk.faces.size());
  if (flips > 0 && share < kFewFlips) return SecondStart::flip_free;
  return std::nullopt;
}

/// Runs the second descent as far as the first one has come. Whether its energy is lower there.
bool overtakes(const Race& race, Descent& second, const Descent& first) {
  const LoopWatch silent{{}, race.watch.stop};
  for (const Bout& bout : kBouts) {
    const int end = std::min(bout.iterations, patience(race));
    run(second, {race.options.tolerance, end}, silent);
    if (energy_after(second, end) > bout.most * energy_after(first, end)) return false;
  }
  run(second, {race.options.tolerance, patience(race)}, silent);
  return second.energy() < first.energy();
}

Solution go_on(const Race& race, Descent descent) {
  const StopReason reason = run(descent, race.options, race.watch);
  return std::move(descent).finish(reason);
}

}  // namespace

Solution run_race(const Race& race, const UvMap& first,
                  const std::function<const UvMap*(SecondStart)>& second) {
  Descent leader(race.assembly, first, race.rigidity, race.executor);
  const StopReason reason = run(leader, {race.options.tolerance, patience(race)}, race.watch);
  const std::optional<SecondStart> wanted = reason_for_second(race, leader, reason);
  const UvMap* other = wanted ? second(*wanted) : nullptr;
  if (other == nullptr) return go_on(race, std::move(leader));
  Descent challenger(race.assembly, *other, race.rigidity, race.executor);
  if (!overtakes(race, challenger, leader)) return go_on(race, std::move(leader));
  challenger.take_over(leader.solution());
  if (race.watch.on_iteration) race.watch.on_iteration(challenger.solution());
  return go_on(race, std::move(challenger));
}

}  // namespace unwrapd
