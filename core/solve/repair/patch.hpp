#pragma once
// Small parts of a disk, to be mended while the rest holds still.

#include <span>
#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/barrier.hpp"

namespace unwrapd::solve::repair {

/// A part of a disk with vertices numbered anew. Those that may move have all their faces in it.
struct Patch {
  BarrierMesh mesh;
  std::vector<Index> face;    ///< patch face -> face of the disk
  std::vector<Index> vertex;  ///< patch vertex -> vertex of the disk
};

/// The map of the disk as the patch has it, by the patch's own numbers; and back.
UvMap map_of(const Patch& patch, std::span<const Vec2> uv);
void put_back(const Patch& patch, std::span<const Vec2> own, UvMap& uv);

/// The connected parts within `rings` rings of the given faces: what a ring is away may move unless
/// held (one a vertex, or empty), their outermost vertices may not. Where most of the disk would be
/// loose, all of it is. Parts in which nothing may move are left out.
std::vector<Patch> patches_around(const Disk& disk, std::span<const Index> faces, int rings,
                                  std::span<const char> constrained);

}  // namespace unwrapd::solve::repair
