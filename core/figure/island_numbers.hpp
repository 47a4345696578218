#pragma once
// The numbers of islands, as they stand on a layout: from 1, in the order of their first faces.

#include <span>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// Where the number of an island stands: in the middle of that face of it which is nearest to the
/// island's own middle.
struct IslandMark {
  Vec2 middle = Vec2::Zero();  ///< UV
  double size = 0;  ///< height of the font, in units of UV, so that it goes into most islands
};

/// Islands are faces that meet at edges of the page; those without an area count, too, so that the
/// numbers are those of the map. unwrapped: all surfaces on the page.
std::vector<IslandMark> island_marks(std::span<const UnwrappedSurface> unwrapped);

}  // namespace unwrapd::figure
