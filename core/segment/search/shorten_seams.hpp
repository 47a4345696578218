#pragma once
// Shortens the borders between regions.

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// Moves every row of seams, from one junction to the next, to the shortest path along edges of the
/// regions on its sides, or to the shortest one nearby, where that saves length and the regions
/// keep a sound map: the excess of each over its area is at most the cap, or the larger one that
/// they had; that of all is at most the budget. Lengths are by seam_cost. Throws Error{cancelled}.
void shorten_seams(const MergeContext& context, const MergeSettings& settings,
                   Partition& partition);

/// The same for the rows between regions a and b alone.
void shorten_between(const MergeContext& context, const MergeSettings& settings, std::size_t a,
                     std::size_t b, Partition& partition);

/// The same where a whole stretch cannot be straight: its halves, their halves, and so on. Takes
/// longer: for the last partition.
void shorten_in_parts(const MergeContext& context, const MergeSettings& settings,
                      Partition& partition);

}  // namespace unwrapd::segment::search
