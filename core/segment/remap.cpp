#include "core/segment/remap.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/segment/test_parameterization.hpp"

namespace unwrapd::segment {

bool remap(const SegmentationMesh& surface, std::span<const char> open, const MergeRules& rules,
           const ExcessDistortion& before, MappedRegion& region, ExcessDistortion& total) {
  throw_if_cancelled(rules.stop);
  const TestRules trial{.most_excess = std::max(rules.cap * region.area, before.worst()),
                        .stop = rules.stop,
                        .memory = rules.memory};
  const TestResult result = test_parameterization(surface, open, trial, region.region);
  if (rules.progress != nullptr) rules.progress->add(region.region.faces.size());
  const ExcessDistortion after = total + result.excess - before;
  if (result.verdict != Verdict::sound || after.worst() > std::max(rules.budget, total.worst()))
    return false;
  region.excess = result.excess;
  total = after;
  return true;
}

}  // namespace unwrapd::segment
