// Reads the texture coordinates of the input, corner by corner: primitives that share a surface's
// vertices need not share these, and an OBJ's vertices have no coordinates of their own.
#include "core/asset/base/as_size.hpp"
#include "core/asset/base/no_uv.hpp"
#include "core/asset/document.hpp"
#include "core/asset/reader/steps.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

void read_obj_uvs(const obj::Obj& obj, Surface& surface) {
  const std::vector<Vec2> vt = obj::texcoords_of(obj);
  if (vt.empty()) return;
  surface.corner_uv.assign(surface.mesh.faces.size(), kNoCornerUv);
  for (const obj::Element& element : obj.elements)
    for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t) {
      check_cancelled_every(t, obj.stop);
      for (std::size_t i = 0; i < 3; ++i) {
        const obj::Corner& corner =
            obj.corners[element.first_corner + as_size(obj.face_corners[t][i])];
        if (corner.texcoord >= 0 && as_size(corner.texcoord) < vt.size())
          surface.corner_uv[t][i] = vt[as_size(corner.texcoord)];
      }
    }
}

void read_mesh_file_uvs(const mesh_files::MeshFile& file, Surface& surface) {
  if (file.uv.empty()) return;
  surface.corner_uv.assign(surface.mesh.faces.size(), kNoCornerUv);
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t) {
    check_cancelled_every(t, file.stop);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& uv = file.uv[as_size(surface.mesh.faces[t][i])];
      if (uv.allFinite()) surface.corner_uv[t][i] = uv;
    }
  }
}

}  // namespace

void read_uvs(Asset& asset) {
  Document& document = asset.document();
  if (const obj::Obj* obj = std::get_if<obj::Obj>(&document.source))
    read_obj_uvs(*obj, document.surfaces.front());
  else if (const mesh_files::MeshFile* file = std::get_if<mesh_files::MeshFile>(&document.source))
    read_mesh_file_uvs(*file, document.surfaces.front());
  else
    reader::read_gltf_uvs(std::get<Gltf>(document.source), document.surfaces);
}

}  // namespace unwrapd::asset
