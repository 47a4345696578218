#pragma once
// Bisecting a region, the inverse of merging.

#include <optional>

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// The partition with region k in two halves. Two faces that lie about as far apart as any in the
/// region are the seeds; each face goes to the nearer one. Empty where a half has no sound map. The
/// second half comes last.
std::optional<Partition> bisect(const MergeContext& context, const Partition& partition,
                                std::size_t k);

}  // namespace unwrapd::segment::search
