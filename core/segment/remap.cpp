#include "core/segment/remap.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/segment/trial.hpp"

namespace unwrapd {

bool remap(const Sheet& sheet, std::span<const char> open, const MergeRules& rules,
           const Excess& before, MappedRegion& region, Excess& total) {
  throw_if_cancelled(rules.stop);
  const TrialRules trial{.most_excess = std::max(rules.cap * region.area, before.worst()),
                         .stop = rules.stop,
                         .memory = rules.memory};
  const TrialResult result = try_map(sheet, open, trial, region.region);
  if (rules.effort != nullptr) rules.effort->add(region.region.faces.size());
  const Excess after = total + result.excess - before;
  if (result.verdict != Verdict::sound || after.worst() > std::max(rules.budget, total.worst()))
    return false;
  region.excess = result.excess;
  total = after;
  return true;
}

}  // namespace unwrapd
