#pragma once
// Which new textures there are, who reads them, and how large they are.

#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/asset/gltf/texture_slots.hpp"

namespace unwrapd::asset::writer {

/// What one primitive reads of a texture.
struct TextureUse {
  std::size_t primitive = 0;
  TextureMapping mapping;
};

/// An image to paint: one old image, for the primitives that read it. A second one is needed only
/// where the same faces read the old image in two ways.
struct NewImage {
  std::size_t image = 0;  ///< the old one
  texture::Content content = texture::Content::values;
  std::vector<TextureUse> uses;
  texture::ImageHead head;  ///< of the old one
  texture::Size size;       ///< of the new one
  bool is_reduced = false;  ///< its detail would need a larger size
};

/// A new texture: a new image, and the old texture that its other members are from.
struct NewTexture {
  std::size_t image = 0;  ///< in TransferPlan::images
  std::size_t old = 0;

  auto operator<=>(const NewTexture&) const = default;
};

struct TransferPlan {
  std::vector<NewImage> images;
  std::vector<NewTexture> textures;
  /// [primitive, old material]: the texture of each of the material's slots.
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> bindings;
};

/// Requires gltf.transfer. Sizes follow from the unwrapped surfaces. Throws Error{cancelled}.
TransferPlan plan_transfer(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped);

/// Of every face of a primitive, the numbers of its vertices in the accessors.
std::vector<std::array<std::size_t, 3>> face_vertices(const Gltf& gltf,
                                                      std::span<const UnwrappedSurface> unwrapped,
                                                      const Primitive& primitive);

/// The faces of a use in both layouts; without frames.
texture::Patch patch_of(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                        const TextureUse& use);

}  // namespace unwrapd::asset::writer
