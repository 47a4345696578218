#pragma once

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// A layout that gives every vertex the UV f(position).
template <class Map>
UnwrappedSurface laid_out(const TriMesh& mesh, Map f) {
  UnwrappedSurface out{mesh.faces, {}, {}};
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    out.source.push_back(v);
    out.uv.push_back(f(mesh.positions[static_cast<std::size_t>(v)]));
  }
  return out;
}

/// Each vertex at its x and y, times `scale`.
inline UnwrappedSurface by_xy(const TriMesh& mesh, double scale = 1) {
  return laid_out(mesh, [&](const Vec3& p) { return Vec2(scale * p.head<2>()); });
}

}  // namespace unwrapd::figure
