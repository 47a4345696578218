#pragma once
// The convex virtual boundary: the paper's way to repair flips (Sec. 4.4, last paragraph).

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::repair {

/// A map near uv that, in exact arithmetic, has no flipped triangle. Each vertex inside the hull of
/// its neighbours keeps its position relative to them. uv has one entry a vertex.
UvMap virtual_boundary_map(const Disk& disk, const UvMap& uv);

}  // namespace unwrapd::solve::repair
