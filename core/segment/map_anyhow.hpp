#pragma once
// A map of a region at any distortion, for where charts shall be few.

#include <span>
#include <stop_token>

#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment {

/// See MapAnyhow. ARAP from a convex map. Where that is flawed, the excess is several times as
/// high: a map without flips and overlaps is going to cost more. Does not throw; a stop request
/// ends it early, with any verdict.
TestResult map_anyhow(const SegmentationMesh& surface, std::span<const char> open,
                      const std::stop_token& stop, Region& region);

}  // namespace unwrapd::segment
