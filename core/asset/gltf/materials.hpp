#pragma once
// The use of texture coordinates by materials.

#include <bitset>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/base/pace.hpp"
#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset {

/// By number: 1 for each set TEXCOORD_n.
using TexcoordSets = std::bitset<kMaxTexcoord + 1>;

/// The use of the texture coordinates of one set by one material.
struct MaterialUse {
  bool moves_texcoord = false;  ///< by the KHR_texture_transform of some texture
  Vec2 scale{1, 1};             ///< of the first texture that reads them; changes shapes, unlike
                                ///< rotation and offset
  std::size_t tangent_set = 0;  ///< TEXCOORD_n that tangents belong to
};

/// Materials by their number.
struct MaterialsToReset {
  std::vector<std::size_t> in_place;  ///< all that they are on is unwrapped
  std::vector<std::size_t> copied;    ///< they are on other primitives, too, which stay as they are
};

/// The materials of a document, each is analysed once.
class Materials {
 public:
  /// texcoord: the set, gltf.texcoord where none is named.
  explicit Materials(const Gltf& gltf) : Materials(gltf, gltf.texcoord) {}
  Materials(const Gltf& gltf, std::string_view texcoord);

  [[nodiscard]] const MaterialUse& of(const Primitive& primitive) const;

  /// Whether the primitive has tangents that belong to the set.
  [[nodiscard]] bool loses_tangents(const Primitive& primitive) const;

  /// Those on unwrapped primitives that move the set by KHR_texture_transform.
  [[nodiscard]] MaterialsToReset to_reset() const;

 private:
  const Gltf& gltf_;
  std::string texcoord_;
  std::vector<MaterialUse> uses_;
};

/// Whether a primitive has texture coordinates by this name, of the type that glTF asks for.
bool has_set(const Gltf& gltf, const Primitive& primitive, std::string_view name);

/// The sets that a primitive has.
TexcoordSets sets_of(const Primitive& primitive);

/// The sets that unwrapped primitives have.
TexcoordSets present_sets(const Gltf& gltf);

/// The sets that unwrapped primitives have and the textures of their materials read.
TexcoordSets sampled_sets(const Gltf& gltf);

/// Calls visit with the number of each material that a primitive can have: its own, and those of
/// KHR_materials_variants. Value: Json or const Json.
template <class Value, class Visit>
void for_each_material(Value& primitive, const Visit& visit) {
  const auto visit_in = [&](Value& object) {
    const auto found = object.find("material");
    if (found != object.end() && found->is_number_unsigned()) visit(*found);
  };
  visit_in(primitive);
  const auto extensions = primitive.find("extensions");
  if (extensions == primitive.end() || !extensions->is_object()) return;
  const auto variants = extensions->find("KHR_materials_variants");
  if (variants == extensions->end() || !variants->is_object()) return;
  const auto mappings = variants->find("mappings");
  if (mappings == variants->end() || !mappings->is_array()) return;
  for (auto& mapping : *mappings)
    if (mapping.is_object()) visit_in(mapping);
}

/// Removes the transforms of gltf.texcoord from a material; an override of the set stays.
void reset_transforms(Json& material, std::string_view texcoord, Pace& pace);

}  // namespace unwrapd::asset
