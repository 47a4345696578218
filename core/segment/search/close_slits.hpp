#pragma once
// Closes slits that a region no longer needs.

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// Glues slits (seams with the same region on both sides) as far as the region keeps a sound map:
/// its excess over its area is at most the cap, or what it was; that of all regions is at most the
/// budget. A slit that ends inside the region is glued from that end, wholly or partly. Throws
/// Error{cancelled}.
void close_slits(const MergeContext& context, const MergeSettings& settings, Partition& partition);

}  // namespace unwrapd::segment::search
