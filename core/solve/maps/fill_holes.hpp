#pragma once
// Inner holes closed, for methods that make a metric flat before they draw it: around an open hole
// a flat metric may turn or grow, and then no map has it.

#include <vector>

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::maps {

/// A disk without inner holes. Its view looks into the two lists: it moves, but is not copied.
struct FilledDisk {
  std::vector<Triangle> faces;      ///< those of the disk first, then the fans
  std::vector<BoundaryLoop> loops;  ///< the longest loop of the disk, alone
  Disk disk;                        ///< its first vertices and rest triangles are the disk's

  FilledDisk() = default;
  FilledDisk(FilledDisk&&) = default;
  FilledDisk& operator=(FilledDisk&&) = default;
};

/// Closes every loop but the longest with a fan about the mean of its vertices: right for plane
/// holes, whatever their shape, and one vertex a hole. A minimal surface would follow crooked rims
/// closer; an ear-cut would bring slivers of its own.
FilledDisk fill_holes(const Disk& disk);

}  // namespace unwrapd::solve::maps
