#pragma once
// The convex virtual boundary: how the paper would mend flips (Sec. 4.4, last paragraph).

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::repair {

/// A map near uv in which, in exact arithmetic, no triangle is flipped whatever uv is: each vertex
/// that lies among its neighbours keeps its place relative to them. uv has one entry a vertex.
UvMap virtual_boundary_map(const Disk& disk, const UvMap& uv);

}  // namespace unwrapd::solve::repair
