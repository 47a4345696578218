// Reads the texture coordinates of the input, corner by corner: primitives that share a surface's
// vertices need not share these, and an OBJ's vertices have no coordinates of their own.
#include <charconv>
#include <limits>

#include "core/asset/as_size.hpp"
#include "core/asset/convert.hpp"
#include "core/asset/document.hpp"
#include "core/asset/elements.hpp"
#include "core/asset/gltf_steps.hpp"
#include "core/asset/materials.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const CornerUv kNoUv = {Vec2(kNone, kNone), Vec2(kNone, kNone), Vec2(kNone, kNone)};

/// The accessor of the primitive's texture coordinates, if it has a type that glTF allows.
std::optional<std::size_t> uv_accessor(const Gltf& gltf, const Primitive& primitive) {
  for (const auto& [semantic, accessor] : primitive.attributes)
    if (semantic == gltf.uvs_from && gltf.accessors[accessor].components == 2) return accessor;
  return std::nullopt;
}

Vec2 upwards(const Vec2& uv) { return uv.allFinite() ? Vec2(uv.x(), 1 - uv.y()) : kNoUv[0]; }

void read_piece(const Gltf& gltf, const Primitive& primitive, const Vec2& scale,
                std::size_t accessor, Surface& surface) {
  const Piece& piece = gltf.pieces[primitive.piece];
  const std::vector<Index>& number = gltf.vertices[piece.surface];
  const Elements uv(gltf, accessor);
  surface.corner_uv.resize(surface.mesh.faces.size(), kNoUv);
  for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
    check_cancelled_every(t, gltf.stop);
    for (std::size_t i = 0; i < 3; ++i)
      surface.corner_uv[t][i] = upwards(
          scale.cwiseProduct(uv.vec2_at(as_size(number[as_size(surface.mesh.faces[t][i])]))));
  }
}

/// The two numbers of a vt statement; NaN if they cannot be read.
Vec2 read_vt(std::string_view line) {
  Vec2 uv(kNone, 0);
  std::size_t at = line.find("vt") + 2;
  for (int k = 0; k < 2; ++k) {
    at = line.find_first_not_of(" \t", at);
    if (at == std::string_view::npos) break;
    if (line[at] == '+') ++at;
    const auto [end, error] = std::from_chars(line.data() + at, line.data() + line.size(), uv[k]);
    if (error != std::errc()) return kNoUv[0];
    at = static_cast<std::size_t>(end - line.data());
  }
  return uv.allFinite() ? uv : kNoUv[0];
}

void read_obj_uvs(const Obj& obj, Surface& surface) {
  const std::vector<Vec2> vt = texcoords_of(obj);
  if (vt.empty()) return;
  surface.corner_uv.assign(surface.mesh.faces.size(), kNoUv);
  for (const ObjElement& element : obj.elements)
    for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t) {
      check_cancelled_every(t, obj.stop);
      for (std::size_t i = 0; i < 3; ++i) {
        const ObjCorner& corner =
            obj.corners[element.first_corner + as_size(obj.face_corners[t][i])];
        if (corner.texcoord >= 0 && as_size(corner.texcoord) < vt.size())
          surface.corner_uv[t][i] = vt[as_size(corner.texcoord)];
      }
    }
}

void read_mesh_file_uvs(const MeshFile& file, Surface& surface) {
  if (file.uv.empty()) return;
  surface.corner_uv.assign(surface.mesh.faces.size(), kNoUv);
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t) {
    check_cancelled_every(t, file.stop);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& uv = file.uv[as_size(surface.mesh.faces[t][i])];
      if (uv.allFinite()) surface.corner_uv[t][i] = uv;
    }
  }
}

}  // namespace

std::vector<Vec2> texcoords_of(const Obj& obj) {
  std::vector<Vec2> vt;
  vt.reserve(obj.texcoord_lines.size());
  for (const auto& [begin, end] : obj.texcoord_lines) {
    check_cancelled_every(vt.size(), obj.stop);
    vt.push_back(read_vt(std::string_view(obj.text).substr(begin, end - begin)));
  }
  return vt;
}

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

void read_uvs(Asset& asset) {
  Document& document = asset.document();
  if (const Obj* obj = std::get_if<Obj>(&document.source))
    read_obj_uvs(*obj, document.surfaces.front());
  else if (const MeshFile* file = std::get_if<MeshFile>(&document.source))
    read_mesh_file_uvs(*file, document.surfaces.front());
  else
    read_gltf_uvs(std::get<Gltf>(document.source), document.surfaces);
}

}  // namespace unwrapd::asset
