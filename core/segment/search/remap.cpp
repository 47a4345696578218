#include "core/segment/search/remap.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment::search {

bool remap(const MergeContext& context, const MergeSettings& settings, std::span<const char> open,
           const ExcessDistortion& before, MappedRegion& region, ExcessDistortion& total) {
  throw_if_cancelled(context.stop);
  const TestRules trial{.most_excess = std::max(settings.cap * region.area, before.worst()),
                        .stop = context.stop,
                        .memory = context.failures};
  const bool is_whole = region.mapped == 0;
  const TestResult result = test_parameterization(context.surface, open, trial, region);
  if (context.progress != nullptr) context.progress->add(region.faces.size());
  const ExcessDistortion after = total + result.excess - before;
  if (result.verdict != Verdict::sound || after.worst() > std::max(settings.budget, total.worst()))
    return false;
  region.excess = result.excess;
  if (is_whole) region.area_added = 0;
  total = after;
  return true;
}

}  // namespace unwrapd::segment::search
