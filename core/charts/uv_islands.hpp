#pragma once
// The islands of the texture coordinates that a surface came with.

#include <vector>

#include "core/charts/charts.hpp"
#include "core/charts/outline.hpp"

namespace unwrapd::charts {

struct UvIslands {
  /// One an island, in the order of their lowest faces: mesh (a vertex for each place of the plane)
  /// and face_source alone are filled. Faces without UVs are set aside.
  Charts charts;
  std::vector<UvMap> maps;        ///< one an island
  std::vector<Outline> outlines;  ///< one an island: what its faces cover, whichever side is up
};

/// Faces belong together where they share a corner: a position with a place in the plane. Empty for
/// a surface without corner_uv.
UvIslands uv_islands(const Surface& surface);

}  // namespace unwrapd::charts
