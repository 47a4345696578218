#pragma once
// The input of topology: a surface without the positions of its vertices.

#include <span>
#include <string>
#include <string_view>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// A view of a surface, which must outlive it.
struct SurfaceNumbers {
  SurfaceNumbers(const Surface& surface)  // NOLINT(google-explicit-constructor): a part of it
      : faces(surface.mesh.faces),
        vertex_count(surface.mesh.vertex_count()),
        part(surface.part),
        name(surface.name),
        corner_uv(surface.corner_uv),
        materials(surface.materials) {}

  std::span<const Triangle> faces;
  Index vertex_count;
  std::span<const Index> part;
  std::string_view name;
  std::span<const CornerUv> corner_uv;
  std::span<const std::string> materials;
};

}  // namespace unwrapd
