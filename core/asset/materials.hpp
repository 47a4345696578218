#pragma once
// The use of texture coordinates by materials.

#include <string_view>
#include <vector>

#include "core/asset/gltf.hpp"
#include "core/asset/pace.hpp"

namespace unwrapd::asset {

/// The use of the texture coordinates gltf.texcoord by one material.
struct MaterialUse {
  bool moves_texcoord = false;  ///< by the KHR_texture_transform of some texture
  Vec2 scale{1, 1};             ///< of the first texture that reads them; changes shapes, unlike
                                ///< rotation and offset
  std::size_t tangent_set = 0;  ///< TEXCOORD_n that tangents belong to
};

/// The materials of a document; each is analysed once.
class Materials {
 public:
  explicit Materials(const Gltf& gltf);

  [[nodiscard]] const MaterialUse& of(const Primitive& primitive) const;

  /// Whether the primitive has tangents that belong to gltf.texcoord.
  [[nodiscard]] bool loses_tangents(const Primitive& primitive) const;

  /// The materials that move gltf.texcoord by KHR_texture_transform, if all their primitives are
  /// unwrapped.
  [[nodiscard]] std::vector<std::size_t> to_reset() const;

 private:
  const Gltf& gltf_;
  std::vector<MaterialUse> uses_;
};

/// Removes the transforms of gltf.texcoord from a material; an override of the set stays.
void reset_transforms(Json& material, std::string_view texcoord, Pace& pace);

}  // namespace unwrapd::asset
