#pragma once
// Segments a surface with a mirror plane so that its seams are symmetric.

#include <optional>

#include "core/charts/charts.hpp"
#include "core/segment/mirror.hpp"
#include "core/segment/segment.hpp"

namespace unwrapd::segment {

/// One half is segmented; the other one gets the images of its regions. Regions are then joined
/// with their images across the plane, and pairs of images to regions that are their own image, as
/// far as the bound allows. Nothing if that takes more regions than the rules allow. component:
/// what surface was made of. Throws Error{cancelled}.
std::optional<Segments> segment_symmetrically(const charts::Chart& component,
                                              const SegmentationMesh& surface, const Mirror& mirror,
                                              const SegmentRules& rules, Executor& executor);

}  // namespace unwrapd::segment
