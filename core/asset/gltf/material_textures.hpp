#pragma once
// The textures of a material, wherever they stand in its JSON.

#include <string>

#include "core/asset/base/pace.hpp"
#include "core/asset/gltf/json.hpp"

namespace unwrapd::asset {

inline constexpr const char* kTransform = "KHR_texture_transform";

/// Value is Json or const Json.
template <class Value>
Value* transform_of(Value& texture) {
  const auto extensions = texture.find("extensions");
  if (extensions == texture.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(kTransform);
  return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

inline std::size_t whole_number(const Json& object, const char* key, std::size_t otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_unsigned() ? found->get<std::size_t>()
                                                              : otherwise;
}

/// The set that a textureInfo reads, with an override by KHR_texture_transform.
inline std::size_t texcoord_of(const Json& texture) {
  const Json* transform = transform_of(texture);
  const std::size_t own = whole_number(texture, "texCoord", 0);
  return transform == nullptr ? own : whole_number(*transform, "texCoord", own);
}

inline std::string set_name(std::size_t set) { return "TEXCOORD_" + std::to_string(set); }

inline bool is_texture(const std::string& key, const Json& value) {
  return key.ends_with("Texture") && value.is_object() && value.contains("index");
}

/// Calls visit with every textureInfo of a material and its key, those of its extensions too.
template <class Value, class Visit>
void for_each_texture(Value& material, Pace& pace, const Visit& visit) {
  if (!material.is_object()) return;
  for (auto& [key, value] : material.items()) {
    pace.add(1);
    if (is_texture(key, value))
      visit(key, value);
    else if (key != "extras")
      for_each_texture(value, pace, visit);
  }
}

}  // namespace unwrapd::asset
