#pragma once
// Bisecting a region, the inverse of merging.

#include <optional>

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// How a region may come apart in two: halfway, or at the neck before one of three of its tips.
inline constexpr std::size_t kWaysToBisect = 4;

/// The partition with region k in two parts. Way 0: two faces that lie about as far apart as any in
/// the region are the seeds; each face goes to the nearer one. Way n: one part is what lies within
/// some distance of tip n, where the cut is short for the area of the smaller part; tips are faces
/// far from each other. Empty where a part has no sound map, or its excess over its area is above
/// the cap and above that of the region. The second part comes last.
std::optional<Partition> bisect(const MergeContext& context, const MergeSettings& settings,
                                const Partition& partition, std::size_t k, std::size_t way = 0);

}  // namespace unwrapd::segment::search
