#pragma once
// What a material's textures are: the image, how it is sampled, what its channels mean.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/asset/base/pace.hpp"
#include "core/asset/gltf/gltf.hpp"
#include "core/texture/codec.hpp"
#include "core/texture/resample.hpp"

namespace unwrapd::asset {

inline constexpr const char* kWebpExtension = "EXT_texture_webp";

/// From the mesh's coordinates to those that the texture is sampled at.
struct TextureMapping {
  texture::Sampling sampling;
  /// Of KHR_texture_transform: u' = rows[0] . (u, v, 1), v' = rows[1] . (u, v, 1).
  std::array<std::array<double, 3>, 2> rows = {{{1, 0, 0}, {0, 1, 0}}};

  double turn = 0;  ///< radians by which a material turns directions in the tangent plane

  bool operator==(const TextureMapping&) const = default;
  [[nodiscard]] Vec2 operator()(const Vec2& uv) const;
};

/// A textureInfo of a material that samples the replaced set.
struct TextureSlot {
  std::size_t texture = 0;
  std::size_t image = 0;
  texture::Content content = texture::Content::values;
  TextureMapping mapping;
};

/// The slots of a material, in the order of its JSON. Throws Error{malformed_gltf};
/// Error{unsupported_image} if a texture has its image in an extension alone, other than
/// EXT_texture_webp, or mixes normals with other numbers.
std::vector<TextureSlot> slots_of(const Gltf& gltf, std::size_t material, Pace& pace);

/// The image that a texture is transferred from: its own source, or else that of EXT_texture_webp.
std::size_t source_image(const Gltf& gltf, std::size_t texture);

/// An image's file. storage: keeps the bytes if they had to be decoded. Throws
/// Error{missing_buffer} if the image lies in a file that was not sent, Error{malformed_gltf}.
texture::ImageFile image_file(const Gltf& gltf, std::size_t image, std::string& storage);

/// Checks every image to be transferred by its head. Throws the errors of the functions above, of
/// texture::head_of(), and Error{too_much_memory}.
void check_textures(const Gltf& gltf);

}  // namespace unwrapd::asset
