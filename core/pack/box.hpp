#pragma once
// The smallest rectangle around an island, at any angle.

#include <array>
#include <optional>
#include <span>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pack {

/// After a rotation by the angle of this cosine and sine, the points fill [low, low + size].
struct Box {
  double cosine = 1;
  double sine = 0;
  Vec2 low = Vec2::Zero();
  Vec2 size = Vec2::Zero();

  [[nodiscard]] Box turned_by_quarter() const {
    return {-sine, cosine, {-low.y() - size.y(), low.x()}, {size.y(), size.x()}};
  }
};

/// What islands are ordered by: sizes that differ by rounding alone tie, and ties are broken by
/// number, so that a mesh moved or scaled is packed in the same way.
inline float size_rank(double size) { return static_cast<float>(size); }

/// The corners of the convex hull, counter-clockwise from the leftmost, without points inside a
/// side. One or two points if there are no more.
UvMap convex_hull(UvMap points);

/// The bounding rectangle of least area; one side of it lies on a side of the hull.
Box smallest_box(std::span<const Vec2> points);

/// The bounding rectangle whose longer side is least, to half a degree of its angle; on a page that
/// is not square, the one for which the page is least. aspect: of the page's height to its width. A
/// point set that has the page to itself is rotated to it.
Box squarest_box(std::span<const Vec2> points, double aspect = 1);

/// The bounding rectangle along or across most of the sides (segments), if at least half of their
/// length has these directions: shapes with right angles fit into each other that way. Else empty.
std::optional<Box> straight_box(std::span<const std::array<Vec2, 2>> sides);

/// The box of the sides (at least one) as they lie (none), or along most of them, else the smallest
/// (quarter, any).
Box resting_box(std::span<const std::array<Vec2, 2>> sides, Rotation rotation);

}  // namespace unwrapd::pack
