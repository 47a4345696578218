// Primitives that share a surface's vertices need not share texture coordinates.
#include "core/asset/base/as_size.hpp"
#include "core/asset/base/no_uv.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/asset/gltf/materials.hpp"
#include "core/asset/reader/steps.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::reader {
namespace {

/// The accessor of the primitive's texture coordinates, if it has a type that glTF allows.
std::optional<std::size_t> uv_accessor(const Gltf& gltf, const Primitive& primitive) {
  for (const auto& [semantic, accessor] : primitive.attributes)
    if (semantic == gltf.uvs_from && gltf.accessors[accessor].components == 2) return accessor;
  return std::nullopt;
}

Vec2 upwards(const Vec2& uv) { return uv.allFinite() ? Vec2(uv.x(), 1 - uv.y()) : kNoUv; }

void read_piece(const Gltf& gltf, const Primitive& primitive, const Vec2& scale,
                std::size_t accessor, Surface& surface) {
  const Piece& piece = gltf.pieces[primitive.piece];
  const std::vector<Index>& number = gltf.vertices[piece.surface];
  const Elements uv(gltf, accessor);
  surface.corner_uv.resize(surface.mesh.faces.size(), kNoCornerUv);
  for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
    check_cancelled_every(t, gltf.stop);
    for (std::size_t i = 0; i < 3; ++i)
      surface.corner_uv[t][i] = upwards(
          scale.cwiseProduct(uv.vec2_at(as_size(number[as_size(surface.mesh.faces[t][i])]))));
  }
}

}  // namespace

void read_gltf_uvs(const Gltf& gltf, std::vector<Surface>& surfaces) {
  const Materials materials(gltf, gltf.uvs_from);
  std::vector<char> is_read(gltf.pieces.size(), 0);
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles || is_read[primitive.piece] != 0) continue;
    const auto accessor = uv_accessor(gltf, primitive);
    if (!accessor) continue;
    is_read[primitive.piece] = 1;
    read_piece(gltf, primitive, materials.of(primitive).scale, *accessor,
               surfaces[gltf.pieces[primitive.piece].surface]);
  }
}

}  // namespace unwrapd::asset::reader
