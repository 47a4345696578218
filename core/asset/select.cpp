// Which primitives are unwrapped. The others are left alone altogether: they make no surface, and
// what they share with a selected one is copied rather than changed.
#include <algorithm>

#include "core/asset/gltf_steps.hpp"

namespace unwrapd::asset {
namespace {

[[noreturn]] void refuse(std::string_view list, std::size_t i, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, Place().at(list).at(i).pointer());
}

std::string name_of(const Gltf& gltf, std::size_t material) {
  const Json& json = gltf.json.at("materials").at(material);
  const auto name = json.find("name");
  return name != json.end() && name->is_string() ? name->get<std::string>() : "";
}

/// Marks the primitives whose material has this name; false when there is none.
bool mark_material(const Gltf& gltf, const std::string& name, std::vector<char>& marked) {
  bool found = false;
  for (std::size_t i = 0; i < gltf.primitives.size(); ++i) {
    const Primitive& primitive = gltf.primitives[i];
    if (!primitive.material || name_of(gltf, *primitive.material) != name) continue;
    marked[i] = 1;
    found = true;
  }
  return found;
}

bool mark_primitive(const Gltf& gltf, const std::string& pointer, std::vector<char>& marked) {
  const auto is_meant = [&](const Primitive& primitive) {
    return primitive_place(primitive).pointer() == pointer;
  };
  const auto found = std::find_if(gltf.primitives.begin(), gltf.primitives.end(), is_meant);
  if (found == gltf.primitives.end()) return false;
  marked[static_cast<std::size_t>(found - gltf.primitives.begin())] = 1;
  return true;
}

}  // namespace

void select_primitives(Gltf& gltf, const AssetOptions& options) {
  if (options.materials.empty() && options.primitives.empty()) return;
  std::vector<char> marked(gltf.primitives.size(), 0);
  for (std::size_t i = 0; i < options.materials.size(); ++i)
    if (!mark_material(gltf, options.materials[i], marked))
      refuse("materials", i, "no primitive has a material of this name; give names of the asset's");
  for (std::size_t i = 0; i < options.primitives.size(); ++i)
    if (!mark_primitive(gltf, options.primitives[i], marked))
      refuse("primitives", i,
             "the asset has no such primitive; point to one, as in /meshes/0/primitives/1");
  for (std::size_t i = 0; i < marked.size(); ++i)
    gltf.primitives[i].has_triangles = gltf.primitives[i].has_triangles && marked[i] != 0;
}

}  // namespace unwrapd::asset
