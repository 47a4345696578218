// Readers cut polygons into triangles in their own ways. If a polygon is convex, every triangle of
// its corners has the polygon's orientation, so it is kept; any other is written as our own
// triangles.
#include "core/asset/obj/polygons.hpp"

#include <algorithm>
#include <cstddef>

#include "core/asset/base/as_size.hpp"

namespace unwrapd::asset::obj {
namespace {

/// Whether all corners turn the same way, once around. Corners at one point count as one, since
/// triangles without area cannot flip.
bool is_convex(UvMap polygon) {
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
  const std::size_t n = polygon.size();
  if (n < 3) return true;
  int left = 0, right = 0, climbs = 0;  // climbs: edges upward that follow one that is not
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % n], &c = polygon[(i + 2) % n];
    // Exact on the page, where texture coordinates are multiples of 2^-24; beyond it, where
    // constraints may put them, exact but for triangles a few steps high.
    const double t = turn(a, b, c);
    left += t > 0 ? 1 : 0;
    right += t < 0 ? 1 : 0;
    climbs += !(b.y() > a.y()) && c.y() > b.y() ? 1 : 0;
  }
  return static_cast<std::size_t>(std::max(left, right)) == n && climbs == 1;
}

}  // namespace

PolygonFate polygon_fate(const Obj& obj, const Element& element, const UnwrappedSurface& unwrapped,
                         std::vector<Index>& texcoords) {
  texcoords.assign(element.corner_count, kUnset);
  for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      Index& slot = texcoords[as_size(obj.face_corners[t][k])];
      const Index texcoord = unwrapped.faces[t][k];
      if (slot != kUnset && slot != texcoord) return PolygonFate::cut;
      slot = texcoord;
    }
  if (element.corner_count <= 3) return PolygonFate::kept;
  UvMap polygon;
  for (const Index texcoord : texcoords)
    polygon.push_back(unwrapped.uv[as_size(texcoord)].cast<float>().cast<double>());
  return is_convex(std::move(polygon)) ? PolygonFate::kept : PolygonFate::folded;
}

std::vector<Note> note_on_polygons(const Obj& obj, const UnwrappedSurface& unwrapped) {
  std::size_t polygons = 0, cut = 0, folded = 0;
  std::vector<Index> texcoords;
  for (const Element& element : obj.elements) {
    if (element.face_count() < 2) continue;
    const PolygonFate fate = polygon_fate(obj, element, unwrapped, texcoords);
    ++polygons;
    cut += fate == PolygonFate::cut ? 1 : 0;
    folded += fate == PolygonFate::folded ? 1 : 0;
  }
  if (cut + folded == 0) return {};
  return {{NoteCode::polygons_split,
           std::to_string(cut + folded) + " of " + std::to_string(polygons) +
               " polygons are written as triangles: " + std::to_string(cut) +
               " because a seam runs through them, " + std::to_string(folded) +
               " because they are not convex on the page, where other diagonals would flip."}};
}

}  // namespace unwrapd::asset::obj
