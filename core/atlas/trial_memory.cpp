#include "core/atlas/trial_memory.hpp"

#include <bit>

#include "core/atlas/scrambled.hpp"

namespace unwrapd {

std::uint64_t trial_key(std::span<const char> open, const TrialRules& rules, const Region& region) {
  std::uint64_t key = 0;
  const auto add = [&](std::uint64_t word) { key = scrambled((key ^ word) + kGoldenStep); };
  const auto add_number = [&](double x) { add(std::bit_cast<std::uint64_t>(x)); };
  add(static_cast<std::uint64_t>(rules.iterations));
  add_number(rules.most_excess);
  for (const Index t : region.faces) {
    auto word = static_cast<std::uint64_t>(t);
    for (Index h = 3 * t; h < 3 * t + 3; ++h)
      word = 2 * word + (!open.empty() && open[static_cast<std::size_t>(h)] != 0 ? 1 : 0);
    add(word);
  }
  for (const CornerUv& corners : region.uv)
    for (const Vec2& uv : corners) add_number(uv.x()), add_number(uv.y());
  return key;
}

std::optional<TrialResult> TrialMemory::find(std::uint64_t key) const {
  const auto found = failed_.find(key);
  if (found != failed_.end()) return found->second;
  return before_ != nullptr ? before_->find(key) : std::nullopt;
}

void TrialMemory::keep(std::uint64_t key, const TrialResult& result) {
  if (result.verdict != Verdict::sound) failed_.emplace(key, result);
}

void TrialMemory::take(TrialMemory other) { failed_.merge(other.failed_); }

}  // namespace unwrapd
