#pragma once
// Islands side by side on one square page, at one texel density, never overlapping.

#include <span>
#include <vector>

#include "core/atlas/charts.hpp"
#include "core/atlas/outline.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// Where an island goes: uv_page = scale * (rotation * uv) + offset. No mirroring: rotation is
/// proper. scale is common to all islands of a page.
struct Placement {
  double cosine = 1;
  double sine = 0;
  double scale = 1;
  Vec2 offset = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& uv) const {
    return scale * Vec2(cosine * uv.x() - sine * uv.y(), sine * uv.x() + cosine * uv.y()) + offset;
  }
};

struct PageOptions {
  int resolution = 1024;  ///< texels a side
  int padding = 2;        ///< texels between islands and to the page's border
};

/// Places the islands (each a UV map at the density it shall keep relative to the others: UV area =
/// 3D area; at least one point each) on the page, in true smallest rectangles, at least the padding
/// apart and from the border. Deterministic; near-linear in the number of islands. Where so many
/// islands come that padding would take more than half of the page's side, it is shrunk to that.
std::vector<Placement> pack_in_rows(std::span<const UvMap> islands, const PageOptions& page);

/// The same by true outlines, into each other's hollows: some 1.4 times the fill for a few hundred
/// times the work (35 ms for five islands). Many thousands of islands stay in rows.
std::vector<Placement> pack(std::span<const Outline> islands, const PageOptions& page);

/// Charts' page UVs back onto the surface's vertices: splits those that lie on a seam. A vertex's
/// first corner keeps its number, copies are appended in the order of faces and corners. Of the
/// faces that were set aside, a duplicate gets the UVs of the face that it repeats; a degenerate
/// one those of its vertices (or of others at their positions), of one of them when they lie in
/// several charts, and (0,0) when there are none.
UnwrappedSurface assemble(const Surface& surface, const Charts& charts,
                          std::span<const UvMap> chart_uv);

}  // namespace unwrapd
