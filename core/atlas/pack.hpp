#pragma once
// Islands side by side on one square page, at one texel density, never overlapping.

#include <span>
#include <vector>

#include "core/atlas/charts.hpp"
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
/// 3D area) on the page. Deterministic; near-linear in the number of islands.
std::vector<Placement> pack(std::span<const UvMap> islands, const PageOptions& page);

/// Charts' page UVs back onto the surface's vertices: splits those that lie on a seam. Faces that
/// were set aside get UVs of their vertices where these have some, else (0,0).
UnwrappedSurface assemble(const Surface& surface, const Charts& charts,
                          std::span<const UvMap> chart_uv);

}  // namespace unwrapd
