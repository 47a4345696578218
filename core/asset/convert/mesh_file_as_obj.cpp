#include "core/asset/base/as_size.hpp"
#include "core/asset/convert/convert.hpp"
#include "core/asset/obj/text.hpp"

namespace unwrapd::asset::convert {

std::string mesh_file_as_obj(const mesh_files::MeshFile& file, const Surface& surface,
                             const UnwrappedSurface& unwrapped) {
  Pace pace(file.stop);
  std::string out;
  for (std::size_t v = 0; v < surface.mesh.positions.size(); ++v) {
    pace.add(8);
    obj::append_v(out, surface.mesh.positions[v],
                  file.colours.empty() ? nullptr : &file.colours[v]);
  }
  for (const Vec2& uv : unwrapped.uv) {
    pace.add(4);
    obj::append_vt(out, uv);
  }
  for (const Vec3& normal : file.normals) {
    pace.add(8);
    obj::append_vn(out, normal.allFinite() ? normal : Vec3(0, 0, 0));
  }
  for (const Triangle& face : unwrapped.faces) {
    pace.add(8);
    out += 'f';
    for (const Index corner : face) {
      const Index vertex = unwrapped.source[as_size(corner)];
      obj::append_indices(out, vertex, corner, file.normals.empty() ? -1 : vertex);
    }
    out += '\n';
  }
  return out;
}

}  // namespace unwrapd::asset::convert
