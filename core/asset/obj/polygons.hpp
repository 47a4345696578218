#pragma once
// Decides which polygons of an OBJ can stay polygons with their texture coordinates.

#include <vector>

#include "core/asset/obj/obj.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::obj {

enum class PolygonFate {
  kept,
  cut,     ///< a seam runs through it: a corner has two texture coordinates
  folded,  ///< not convex on the page: a reader with other diagonals would see flips
};

inline constexpr Index kUnset = -1;  ///< texture coordinates of a corner that has none yet

/// Twice the signed area of abc: > 0 where it turns left.
inline double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The fate of a face element. texcoords: those of its corners, if it is kept.
PolygonFate polygon_fate(const Obj& obj, const Element& element, const UnwrappedSurface& unwrapped,
                         std::vector<Index>& texcoords);

/// A note on the polygons that write_obj() writes as triangles, with the reason; empty if all stay.
std::vector<Note> note_on_polygons(const Obj& obj, const UnwrappedSurface& unwrapped);

}  // namespace unwrapd::asset::obj
