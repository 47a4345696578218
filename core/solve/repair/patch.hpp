#pragma once
// Small parts of a disk, which are repaired while the rest is fixed.

#include <span>
#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/barrier.hpp"

namespace unwrapd::solve::repair {

/// A part of a disk with its own vertex numbers. All faces of its free vertices belong to it.
struct Patch {
  BarrierMesh mesh;
  std::vector<Index> face;    ///< patch face -> face of the disk
  std::vector<Index> vertex;  ///< patch vertex -> vertex of the disk
};

/// The map restricted to the patch, in the patch's numbers; and the way back.
UvMap map_of(const Patch& patch, std::span<const Vec2> uv);
void put_back(const Patch& patch, std::span<const Vec2> own, UvMap& uv);

/// The connected parts within `rings` rings of the given faces. Vertices within the rings are free
/// unless constrained (one a vertex, or empty); the outermost vertices are fixed. If most of the
/// disk would be free, all of it is. Parts without a free vertex are left out.
std::vector<Patch> patches_around(const Disk& disk, std::span<const Index> faces, int rings,
                                  std::span<const char> constrained);

}  // namespace unwrapd::solve::repair
