#pragma once
// Says in notes what is wrong with a result, so that no fault passes in silence.

#include <span>

#include "core/pipeline/layout.hpp"

namespace unwrapd::pipeline {

/// The distortion that textures bear: charts beyond it are told where no bound is asked for.
inline constexpr double kBearableDistortion = 2.1;

/// Notes charts that are distorted beyond options.max_distortion, or kBearableDistortion, and
/// charts whose triangles overlap. Requires the figures of measure_maps().
void note_faults(Layout& layout, std::span<const Surface> surfaces, const UnwrapOptions& options);

}  // namespace unwrapd::pipeline
