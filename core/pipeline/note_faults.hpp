#pragma once
// Says in notes what is wrong with a result, so that no fault passes in silence.

#include <span>

#include "core/pipeline/layout.hpp"

namespace unwrapd::pipeline {

/// The distortion of one chart that textures bear. A bound asked for holds for the mean over all.
inline constexpr double kBearableDistortion = 2.1;

/// Notes a mean distortion beyond options.max_distortion, charts distorted beyond both that and
/// kBearableDistortion, charts whose triangles overlap, and islands smaller than a texel; and seams
/// at UVs where there are none. Requires the figures of measure_maps().
void note_faults(Layout& layout, std::span<const Surface> surfaces, const UnwrapOptions& options);

}  // namespace unwrapd::pipeline
