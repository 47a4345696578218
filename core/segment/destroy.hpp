#pragma once
// A part of a partition taken apart again.

#include <cstdint>

#include "core/segment/merge.hpp"

namespace unwrapd::segment {

/// The regions that stayed whole come first.
struct Destroyed {
  Partition partition;
  Index whole = 0;  ///< how many stayed whole
};

/// One region of `merged` and neighbours of it, up to some share of the area, fall back to the
/// patches of `from` that they were merged from. lot: which; each is the same for everybody.
Destroyed destroy(const SegmentationMesh& surface, const Partition& from, const Partition& merged,
                  std::uint64_t seed);

/// The region of each face.
std::vector<Index> owners(const SegmentationMesh& surface, const Partition& partition);

}  // namespace unwrapd::segment
