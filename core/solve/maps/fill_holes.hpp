#pragma once
// Closes inner holes, for methods that flatten a metric before they lay it out. Around an open hole
// a flat metric may have a rotation or a scaling, and then no map has that metric.

#include <vector>

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::maps {

/// A disk without inner holes. `disk` is a view of the two lists, so that this type can be moved
/// but not copied.
struct FilledDisk {
  std::vector<Triangle> faces;      ///< those of the disk first, then the fans
  std::vector<BoundaryLoop> loops;  ///< only the longest loop of the disk
  Disk disk;                        ///< its first vertices and rest triangles are the disk's

  FilledDisk() = default;
  FilledDisk(FilledDisk&&) = default;
  FilledDisk& operator=(FilledDisk&&) = default;
};

/// Closes every loop but the longest with a fan about the mean of its vertices. This suits plane
/// holes of any shape and costs one vertex a hole. A minimal surface would follow crooked rims more
/// closely; ear clipping would add slivers.
FilledDisk fill_holes(const Disk& disk);

}  // namespace unwrapd::solve::maps
