// KHR_texture_transform moves texture coordinates between the mesh and the texture. New ones lie on
// the page as they shall be read, so the transforms of their set go; all else of a material stays.
#include "core/asset/materials.hpp"

#include <algorithm>

#include "core/asset/gltf_steps.hpp"

namespace unwrapd::asset {
namespace {

constexpr const char* kTransform = "KHR_texture_transform";

Json* transform_of(Json& texture) {
  const auto extensions = texture.find("extensions");
  if (extensions == texture.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(kTransform);
  return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

std::size_t whole_number(const Json& object, const char* key, std::size_t otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_unsigned() ? found->get<std::size_t>()
                                                              : otherwise;
}

std::string set_name(const Json& texture) {
  return "TEXCOORD_" + std::to_string(texcoord_of(texture));
}

bool is_texture(const std::string& key, const Json& value) {
  return key.ends_with("Texture") && value.is_object() && value.contains("index");
}

/// Whether a transform does anything to coordinates; an override of the set alone does not.
bool moves(const Json& transform) {
  return transform.contains("offset") || transform.contains("rotation") ||
         transform.contains("scale");
}

/// Whether a texture of the material moves the coordinates of this set.
bool is_moved(Json material, std::string_view texcoord) {
  bool moved = false;
  for_each_texture(material, [&](Json& texture) {
    const Json* transform = transform_of(texture);
    moved |= transform != nullptr && moves(*transform) && set_name(texture) == texcoord;
  });
  return moved;
}

Json material_json(const Gltf& gltf, const Primitive& primitive) {
  return primitive.material ? gltf.json.at("materials").at(*primitive.material) : Json::object();
}

}  // namespace

void for_each_texture(Json& material, const std::function<void(Json&)>& visit) {
  if (!material.is_object()) return;
  for (auto& [key, value] : material.items()) {
    if (is_texture(key, value))
      visit(value);
    else if (key != "extras")
      for_each_texture(value, visit);
  }
}

std::size_t texcoord_of(const Json& texture) {
  Json copy = texture;
  const Json* transform = transform_of(copy);
  const std::size_t own = whole_number(texture, "texCoord", 0);
  return transform == nullptr ? own : whole_number(*transform, "texCoord", own);
}

Vec2 texture_scale(const Gltf& gltf, const Primitive& primitive) {
  std::optional<Vec2> scale;
  Json material = material_json(gltf, primitive);
  for_each_texture(material, [&](Json& texture) {
    if (scale || set_name(texture) != gltf.texcoord) return;
    scale = Vec2(1, 1);
    const Json* transform = transform_of(texture);
    if (transform == nullptr || !transform->contains("scale")) return;
    const Json& given = transform->at("scale");
    const auto is_number = [](const Json& value) { return value.is_number(); };
    if (given.is_array() && given.size() == 2 && std::all_of(given.begin(), given.end(), is_number))
      scale = Vec2(given[0].get<double>(), given[1].get<double>());
  });
  return scale.value_or(Vec2(1, 1));
}

bool loses_tangents(const Gltf& gltf, const Primitive& primitive) {
  const auto is_tangent = [](const auto& item) { return item.first == "TANGENT"; };
  if (std::none_of(primitive.attributes.begin(), primitive.attributes.end(), is_tangent))
    return false;
  const Json material = material_json(gltf, primitive);
  const auto normal_map = material.find("normalTexture");
  const bool has_map = normal_map != material.end() && normal_map->is_object();
  return gltf.texcoord == (has_map ? set_name(*normal_map) : "TEXCOORD_0");
}

std::vector<std::size_t> materials_to_reset(const Gltf& gltf) {
  const auto list = gltf.json.find("materials");
  if (list == gltf.json.end()) return {};
  std::vector<char> is_on(list->size(), 0), is_kept(list->size(), 0);
  for (const Primitive& primitive : gltf.primitives)
    if (primitive.material) (primitive.has_triangles ? is_on : is_kept)[*primitive.material] = 1;
  std::vector<std::size_t> materials;
  for (std::size_t i = 0; i < list->size(); ++i) {
    if (is_on[i] == 0 || is_kept[i] != 0) continue;
    if (is_moved(list->at(i), gltf.texcoord)) materials.push_back(i);
  }
  return materials;
}

void reset_transforms(Json& material, std::string_view texcoord) {
  for_each_texture(material, [&](Json& texture) {
    Json* transform = transform_of(texture);
    if (transform == nullptr || set_name(texture) != texcoord) return;
    for (const char* part : {"offset", "rotation", "scale"}) transform->erase(part);
    if (transform->empty()) remove_extension(texture, kTransform);
  });
}

}  // namespace unwrapd::asset
