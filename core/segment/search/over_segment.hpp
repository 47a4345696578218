#pragma once
// Over-segmentation: a surface in many small, nearly flat regions, which merging starts from.

#include <vector>

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// Regions whose maps are sound and together use only a part of the excess that is allowed, so that
/// merging can spend the rest. The context needs a progress estimate. Throws Error{cancelled}.
std::vector<MappedRegion> over_segment(const MergeContext& context, double excess,
                                       Executor& executor);

}  // namespace unwrapd::segment::search
