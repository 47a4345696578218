#pragma once
// Attaches small regions to a neighbour along a part of their common border.

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

inline constexpr double kSmallRegion =
    0.01;  ///< of the surface's area: below that a region is small

/// Each small region becomes part of a neighbour if the two have a sound map with some of their
/// common border glued, down to one edge; the rest of the border stays a slit. Seams do not grow,
/// and there are fewer charts. The excess keeps the bounds of merging.
/// Throws Error{cancelled}.
void attach_small_charts(const MergeContext& context, const MergeSettings& settings,
                         Partition& partition);

}  // namespace unwrapd::segment::search
