#pragma once
// The islands of the texture coordinates of the input.

#include <vector>

#include "core/charts/charts.hpp"
#include "core/charts/outline.hpp"

namespace unwrapd::charts {

struct UvIslands {
  /// One an island, ordered by their lowest faces. Only mesh (a vertex for each place of the plane)
  /// and face_source are set. Faces without UVs are in set_aside.
  Charts charts;
  std::vector<UvMap> maps;  ///< one an island
  std::vector<Outline>
      outlines;  ///< one an island: the area of its faces, whatever their orientation
};

/// Faces belong to one island if they share a corner: a position with a UV, and with
/// a material where the surface names them. Empty for a surface
/// without corner_uv.
UvIslands uv_islands(const Surface& surface);

}  // namespace unwrapd::charts
