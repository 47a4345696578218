#pragma once
// Slits that a region no longer needs.

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

/// Slits (seams with the same region on both sides) are glued as far as the region keeps a sound
/// map: excess of it over its area at most cap (or what it had), of all regions at most budget. One
/// that ends inside of the region is glued from there, all of it or a part. Throws
/// Error{cancelled}.
void close_slits(const SegmentationMesh& surface, const MergeRules& rules, Partition& partition);

}  // namespace unwrapd::segment
