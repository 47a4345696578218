#pragma once
// Which polygons of an OBJ can stay polygons once they have texture coordinates.

#include <vector>

#include "core/asset/obj.hpp"

namespace unwrapd::asset {

enum class PolygonFate {
  kept,
  cut,     ///< a seam runs through it: a corner has two texture coordinates
  folded,  ///< not convex on the page: a reader with other diagonals than ours would see flips
};

inline constexpr Index kUnset = -1;  ///< of a corner's texture coordinates

/// What becomes of a face element. texcoords: those of its corners, where it is kept.
PolygonFate polygon_fate(const Obj& obj, const ObjElement& element,
                         const UnwrappedSurface& unwrapped, std::vector<Index>& texcoords);

/// A sentence on the polygons that write_obj() writes as triangles, and why; none where all stay.
std::vector<std::string> note_on_polygons(const Obj& obj, const UnwrappedSurface& unwrapped);

}  // namespace unwrapd::asset
