#pragma once
// A new map for a changed region, within the bounds of merging.

#include <span>

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// Tests a map of the region, glued except at `open`, that replaces maps of the excess `before`.
/// The answer is true where the map is sound and the excess keeps the bounds of the settings, or
/// does not grow; the map is then the region's and counted in total, which is of all regions. Else
/// the region is unusable. Throws Error{cancelled}.
bool remap(const MergeContext& context, const MergeSettings& settings, std::span<const char> open,
           const ExcessDistortion& before, MappedRegion& region, ExcessDistortion& total);

}  // namespace unwrapd::segment::search
