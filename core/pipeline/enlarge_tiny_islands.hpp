#pragma once
// Islands that would be too small for the precision in which UVs are written.

#include "core/pipeline/layout.hpp"

namespace unwrapd::pipeline {

/// Scales maps that are too small beside all others, so that a usual triangle has some steps of
/// guarantee::kUvStep a side: beside a terrain, a bolt keeps its maps. Such an island is some
/// texels wide at most. All maps are in units of length that they have in common, before they are
/// packed.
void enlarge_tiny_islands(Layout& layout);

}  // namespace unwrapd::pipeline
