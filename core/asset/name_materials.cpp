#include <algorithm>

#include "core/asset/base/as_size.hpp"
#include "core/asset/document.hpp"

namespace unwrapd::asset {
namespace {

/// One name for each part of the surface.
void make_room(Surface& surface) {
  const auto last = std::ranges::max_element(surface.part);
  surface.materials.resize(last == surface.part.end() ? 0 : as_size(*last) + 1);
}

void name_gltf_materials(const Gltf& gltf, std::vector<Surface>& surfaces) {
  std::vector<char> is_named(gltf.pieces.size(), 0);
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles || is_named[primitive.piece] != 0) continue;
    is_named[primitive.piece] = 1;
    if (primitive.material)
      surfaces[gltf.pieces[primitive.piece].surface].materials[primitive.number] =
          Place().at("materials").at(*primitive.material).pointer();
  }
}

}  // namespace

void name_materials(Asset& asset) {
  Document& document = asset.document();
  for (Surface& surface : document.surfaces) make_room(surface);
  if (const Gltf* gltf = std::get_if<Gltf>(&document.source))
    return name_gltf_materials(*gltf, document.surfaces);
  if (const obj::Obj* obj = std::get_if<obj::Obj>(&document.source)) {
    std::vector<std::string>& names = document.surfaces.front().materials;
    std::copy_n(obj->materials.begin(), std::min(names.size(), obj->materials.size()),
                names.begin());
  }
}

}  // namespace unwrapd::asset
