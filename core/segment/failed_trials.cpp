#include "core/segment/failed_trials.hpp"

#include <array>
#include <bit>

#include "core/base/splitmix64.hpp"

namespace unwrapd::segment {

std::uint64_t trial_key(std::span<const char> open, const TestRules& rules, const Region& region) {
  std::uint64_t key = 0;
  const auto mix = [](std::uint64_t& sum, std::uint64_t word) {
    sum = splitmix64((sum ^ word) + kGoldenStep);
  };
  const auto add = [&](std::uint64_t word) { mix(key, word); };
  add(static_cast<std::uint64_t>(rules.iterations));
  add(std::bit_cast<std::uint64_t>(rules.most_excess));
  for (const Index t : region.faces) {
    auto word = static_cast<std::uint64_t>(t);
    for (Index h = 3 * t; h < 3 * t + 3; ++h)
      word = 2 * word + (!open.empty() && open[static_cast<std::size_t>(h)] != 0 ? 1 : 0);
    add(word);
  }
  std::array<std::uint64_t, 6> of_corners{};  // sums abreast: none waits for another
  for (const CornerUv& corners : region.uv)
    for (std::size_t k = 0; k < of_corners.size(); ++k)
      mix(of_corners[k], std::bit_cast<std::uint64_t>(corners[k / 2][k % 2]));
  for (const std::uint64_t sum : of_corners) add(sum);
  return key;
}

std::optional<TestResult> FailedTrials::find(std::uint64_t key) const {
  const auto found = failed_.find(key);
  if (found != failed_.end()) return found->second;
  return before_ != nullptr ? before_->find(key) : std::nullopt;
}

void FailedTrials::keep(std::uint64_t key, const TestResult& result) {
  if (result.verdict != Verdict::sound) failed_.emplace(key, result);
}

void FailedTrials::take(FailedTrials other) { failed_.merge(other.failed_); }

}  // namespace unwrapd::segment
