#pragma once
// The smallest rectangle around an island, at whatever angle.

#include <array>
#include <optional>
#include <span>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::pack {

/// Turned by the angle whose cosine and sine these are, the points fill [low, low + size].
struct Box {
  double cosine = 1;
  double sine = 0;
  Vec2 low = Vec2::Zero();
  Vec2 size = Vec2::Zero();

  [[nodiscard]] Box turned_by_quarter() const {
    return {-sine, cosine, {-low.y() - size.y(), low.x()}, {size.y(), size.x()}};
  }
};

/// The corners of the convex hull, counter-clockwise from the leftmost; points on a side are left
/// out. One or two points when that is all there is.
UvMap convex_hull(UvMap points);

/// The bounding rectangle of least area; one side of it lies on a side of the hull.
Box smallest_box(std::span<const Vec2> points);

/// The bounding rectangle whose longer side is least, to half a degree of its angle: what a point
/// set that has the page to itself should be turned to.
Box squarest_box(std::span<const Vec2> points);

/// The bounding rectangle along or across most of the sides (segments), where half of their length
/// or more lies so: shapes with right angles fit into each other that way. Nothing otherwise.
std::optional<Box> straight_box(std::span<const std::array<Vec2, 2>> sides);

}  // namespace unwrapd::pack
