#pragma once
// A part of a partition taken apart again.

#include <cstdint>

#include "core/segment/merge.hpp"

namespace unwrapd {

/// The regions that stayed whole come first.
struct Loosened {
  Partition partition;
  Index whole = 0;  ///< how many stayed whole
};

/// One region of `merged` and neighbours of it, up to some share of the area, fall back to the
/// patches of `from` that they were merged from. lot: which; each is the same for everybody.
Loosened loosened(const Sheet& sheet, const Partition& from, const Partition& merged,
                  std::uint64_t lot);

/// The region of each face.
std::vector<Index> owners(const Sheet& sheet, const Partition& partition);

}  // namespace unwrapd
