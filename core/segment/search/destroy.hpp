#pragma once
// The first half of large-neighbourhood search: a part of a partition falls apart again.

#include <cstdint>

#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// The regions that stayed whole come first.
struct Destroyed {
  Partition partition;
  Index whole = 0;  ///< how many stayed whole
};

/// A random region of `merged` and some of its neighbours, up to a share of the area, fall back to
/// the regions of `from` that they were merged from. Equal seeds make the same choice.
Destroyed destroy(const SegmentationMesh& surface, const Partition& from, const Partition& merged,
                  std::uint64_t seed);

}  // namespace unwrapd::segment::search
