#pragma once
// The borders between regions drawn shorter.

#include <stop_token>

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

/// Every border between two regions, from one junction of borders to the next, is moved to the
/// shortest path over the edges of both, where that saves length and both regions keep a sound map:
/// excess of one over its area at most cap (or what both had), of all at most budget.
/// Throws Error{cancelled}.
void shorten_seams(const SegmentationMesh& surface, const MergeRules& rules, Partition& partition);

}  // namespace unwrapd::segment
