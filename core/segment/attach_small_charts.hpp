#pragma once
// Small regions hung on a neighbour by a piece of their common border.

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

inline constexpr double kSmallRegion =
    0.01;  ///< of the surface's area: below that a region is small

/// Each small region that no neighbour took as a whole becomes part of one where the two have a
/// sound map with some of their common border glued, down to one edge; the rest of it stays a slit.
/// Seams grow by nothing, and there are fewer charts. Excess: as merging bounds it.
/// Throws Error{cancelled}.
void attach_small_charts(const SegmentationMesh& surface, const MergeRules& rules,
                         Partition& partition);

}  // namespace unwrapd::segment
