// KHR_texture_transform moves texture coordinates between the mesh and the texture. New coordinates
// are final, so the transforms of their set are removed; the rest of a material stays.
#include "core/asset/gltf/materials.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "core/asset/gltf/extensions.hpp"
#include "core/asset/gltf/material_textures.hpp"

namespace unwrapd::asset {
namespace {

/// Whether a transform changes coordinates; an override of the set alone does not.
bool moves(const Json& transform) {
  return transform.contains("offset") || transform.contains("rotation") ||
         transform.contains("scale");
}

std::optional<Vec2> scale_of(const Json& transform) {
  const auto given = transform.find("scale");
  const auto is_number = [](const Json& value) { return value.is_number(); };
  if (given == transform.end() || !given->is_array() || given->size() != 2 ||
      !std::all_of(given->begin(), given->end(), is_number))
    return std::nullopt;
  return Vec2((*given)[0].get<double>(), (*given)[1].get<double>());
}

/// Textures in tangent space, in descending precedence of their sets.
constexpr std::array<std::string_view, 3> kTangentTextures = {
    "normalTexture", "clearcoatNormalTexture", "anisotropyTexture"};

MaterialUse use_of(const Json& material, std::string_view texcoord, Pace& pace) {
  MaterialUse use;
  bool is_read = false;
  std::array<std::optional<std::size_t>, kTangentTextures.size()> tangent_sets;
  for_each_texture(material, pace, [&](const std::string& key, const Json& texture) {
    const std::size_t set = texcoord_of(texture);
    for (std::size_t k = 0; k < kTangentTextures.size(); ++k)
      if (key == kTangentTextures[k] && !tangent_sets[k]) tangent_sets[k] = set;
    if (set_name(set) != texcoord) return;
    const Json* transform = transform_of(texture);
    if (transform != nullptr && moves(*transform)) use.moves_texcoord = true;
    if (!is_read && transform != nullptr) use.scale = scale_of(*transform).value_or(use.scale);
    is_read = true;
  });
  for (std::size_t k = kTangentTextures.size(); k-- > 0;)
    use.tangent_set = tangent_sets[k].value_or(use.tangent_set);
  return use;
}

/// The sets that the textures of a material read.
TexcoordSets sets_read_by(const Json& material, Pace& pace) {
  TexcoordSets sets;
  for_each_texture(material, pace, [&](const std::string& /*key*/, const Json& texture) {
    if (const std::size_t set = texcoord_of(texture); set < sets.size()) sets.set(set);
  });
  return sets;
}

}  // namespace

TexcoordSets sets_of(const Primitive& primitive) {
  TexcoordSets sets;
  for (const auto& [semantic, accessor] : primitive.attributes)
    for (std::size_t set = 0; set < sets.size(); ++set)
      if (semantic == set_name(set)) sets.set(set);
  return sets;
}

bool has_set(const Gltf& gltf, const Primitive& primitive, std::string_view name) {
  return std::ranges::any_of(primitive.attributes, [&](const auto& item) {
    return item.first == name && gltf.accessors[item.second].components == 2;
  });
}

TexcoordSets present_sets(const Gltf& gltf) {
  TexcoordSets present;
  for (const Primitive& primitive : gltf.primitives)
    if (primitive.has_triangles) present |= sets_of(primitive);
  return present;
}

TexcoordSets sampled_sets(const Gltf& gltf) {
  const auto materials = gltf.json.find("materials");
  if (materials == gltf.json.end()) return {};
  Pace pace(gltf.stop);
  std::vector<std::optional<TexcoordSets>> read(materials->size());
  TexcoordSets sampled;
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    for_each_material(json_of(gltf.json, primitive), [&](const Json& number) {
      pace.add(1);
      const auto i = number.get<std::size_t>();
      if (i >= read.size()) return;
      if (!read[i]) read[i] = sets_read_by((*materials)[i], pace);
      sampled |= *read[i] & sets_of(primitive);
    });
  }
  return sampled;
}

Materials::Materials(const Gltf& gltf, std::string_view texcoord)
    : gltf_(gltf), texcoord_(texcoord) {
  const auto list = gltf.json.find("materials");
  if (list == gltf.json.end()) return;
  Pace pace(gltf.stop);
  uses_.reserve(list->size());
  for (const Json& material : *list) uses_.push_back(use_of(material, texcoord_, pace));
}

const MaterialUse& Materials::of(const Primitive& primitive) const {
  static const MaterialUse none;
  return primitive.material ? uses_[*primitive.material] : none;
}

bool Materials::loses_tangents(const Primitive& primitive) const {
  const auto is_tangent = [](const auto& item) { return item.first == "TANGENT"; };
  return std::any_of(primitive.attributes.begin(), primitive.attributes.end(), is_tangent) &&
         texcoord_ == set_name(of(primitive).tangent_set);
}

MaterialsToReset Materials::to_reset() const {
  std::vector<char> is_on(uses_.size(), 0), is_kept(uses_.size(), 0);
  Pace pace(gltf_.stop);
  for (const Primitive& primitive : gltf_.primitives)
    for_each_material(json_of(gltf_.json, primitive), [&](const Json& number) {
      pace.add(1);
      const auto material = number.get<std::size_t>();
      if (material < uses_.size()) (primitive.has_triangles ? is_on : is_kept)[material] = 1;
    });
  MaterialsToReset to_reset;
  for (std::size_t i = 0; i < uses_.size(); ++i)
    if (is_on[i] != 0 && uses_[i].moves_texcoord)
      (is_kept[i] == 0 ? to_reset.in_place : to_reset.copied).push_back(i);
  return to_reset;
}

void reset_transforms(Json& material, std::string_view texcoord, Pace& pace) {
  for_each_texture(material, pace, [&](const std::string& /*key*/, Json& texture) {
    Json* transform = transform_of(texture);
    if (transform == nullptr || set_name(texcoord_of(texture)) != texcoord) return;
    for (const char* part : {"offset", "rotation", "scale"}) transform->erase(part);
    if (transform->empty()) remove_extension(texture, kTransform);
  });
}

}  // namespace unwrapd::asset
