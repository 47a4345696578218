#pragma once
// A map of a region at any distortion, for where charts shall be few.

#include <span>
#include <stop_token>

#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment {

/// What a flawed map is taken to cost beside its energy: one without flips and overlaps is going to
/// cost more.
inline constexpr double kFlawedExcess = 3;

/// See MapAnyhow. ARAP from a convex map. Does not throw; a stop request ends it early, with any
/// verdict.
TestResult map_anyhow(const SegmentationMesh& surface, std::span<const char> open,
                      const std::stop_token& stop, Region& region);

}  // namespace unwrapd::segment
