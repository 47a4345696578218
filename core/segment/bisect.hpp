#pragma once
// A region cut across: the other way from merging.

#include <optional>

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

/// The partition with region k as two: each face goes to the nearer of two that lie about as far
/// apart as faces of the region can. Nothing where the halves have no sound maps. The second half
/// comes last.
std::optional<Partition> bisect(const SegmentationMesh& surface, const Partition& partition,
                                std::size_t k, const MergeRules& rules);

}  // namespace unwrapd::segment
