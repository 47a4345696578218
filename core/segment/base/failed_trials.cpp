#include "core/segment/base/failed_trials.hpp"

#include "core/base/splitmix64.hpp"

namespace unwrapd::segment {

std::uint64_t trial_key(std::span<const char> open, const TestRules& rules, const Region& region) {
  const std::uint64_t keeps = region.mapped > 0 ? 1 : 0;
  std::uint64_t sum = splitmix64(2 * static_cast<std::uint64_t>(rules.iterations) + keeps);
  for (const Index t : region.faces) {
    auto word = static_cast<std::uint64_t>(t);
    for (Index h = 3 * t; h < 3 * t + 3; ++h)
      word = 2 * word + (!open.empty() && open[static_cast<std::size_t>(h)] != 0 ? 1 : 0);
    sum += splitmix64((word + 1) * kGoldenStep);  // in any order
  }
  return sum;
}

std::optional<TestResult> FailedTrials::find(std::uint64_t key, double most_excess) const {
  const auto found = failed_.find(key);
  if (found == failed_.end())
    return before_ != nullptr ? before_->find(key, most_excess) : std::nullopt;
  const TestResult& result = found->second;
  if (result.verdict == Verdict::distorted && result.excess.worst() <= most_excess)
    return std::nullopt;
  return result;
}

void FailedTrials::keep(std::uint64_t key, const TestResult& result) {
  if (result.verdict != Verdict::sound) failed_.emplace(key, result);
}

void FailedTrials::take(FailedTrials other) { failed_.merge(other.failed_); }

}  // namespace unwrapd::segment
