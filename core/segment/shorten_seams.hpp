#pragma once
// Shortens the borders between regions.

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

/// Moves every border between two regions, from one junction of borders to the next, to the
/// shortest path along edges of both, where that saves length and both regions keep a sound map:
/// the excess of each over its area is at most the cap, or what both had; that of all is at most
/// the budget. Throws Error{cancelled}.
void shorten_seams(const MergeContext& context, const MergeSettings& settings,
                   Partition& partition);

}  // namespace unwrapd::segment
