#pragma once
// A region's map made anew, as far as merging would allow it.

#include <span>

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

/// Tries a map of the region, glued but for `open`, in the place of those whose excess was
/// `before`. Where it is sound and excess stays within the rules' bounds, or where it was, it is
/// the region's, total (of all patches) says so, and the answer is true; else the region is of no
/// use. Throws Error{cancelled}.
bool remap(const SegmentationMesh& surface, std::span<const char> open, const MergeRules& rules,
           const ExcessDistortion& before, MappedRegion& region, ExcessDistortion& total);

}  // namespace unwrapd::segment
