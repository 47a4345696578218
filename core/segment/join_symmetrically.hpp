#pragma once
// From the regions of one half of a symmetric surface to those of all of it.

#include <optional>
#include <span>
#include <stop_token>

#include "core/charts/split_chart.hpp"
#include "core/segment/mirror.hpp"
#include "core/segment/segment.hpp"

namespace unwrapd::segment {

/// The regions of a part in front of the plane.
struct FrontRegions {
  const charts::ChartPart& part;
  const Segments& segments;  ///< of the part, in units in which its area is 1
  double area;               ///< of the part; the surface's is 1
};

/// These regions and their images, joined across the plane as far as the excess allows, those with
/// the longest common borders first. Nothing where the image of a region is no disk, or its map is
/// distorted beyond the excess, which a mesh that is not quite symmetric may cause. Throws
/// Error{cancelled}.
std::optional<Segments> join_symmetrically(const SegmentationMesh& surface, const Mirror& mirror,
                                           std::span<const FrontRegions> front, double excess,
                                           const std::stop_token& stop);

}  // namespace unwrapd::segment
