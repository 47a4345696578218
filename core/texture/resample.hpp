#pragma once
// Paints a new texture from an old one: every triangle of the new layout shows what it shows in the
// old one.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/texture/texture.hpp"

namespace unwrapd::texture {

/// What the channels of an image mean.
enum class Content {
  colour,     ///< sRGB
  values,     ///< numbers, as they are
  normals,    ///< red, green, blue: a vector in the tangent frame, [0, 1] for [-1, 1]
  directions  ///< red, green: a vector in the tangent plane, likewise; blue is a number
};

/// The two places of a triangle, V pointing down: `to` in the page [0, 1] x [0, 1], `from` where
/// the texture is sampled, anywhere.
struct PlacedTriangle {
  std::array<Eigen::Vector2f, 3> from, to;
};

/// The tangent frames at a triangle's corners, in both layouts: unit vectors, and the sign of the
/// bitangent, sign * normal x tangent.
struct TurnedFrames {
  struct Corner {
    Eigen::Vector3f normal, from, to;  ///< normal, tangents
  };
  std::array<Corner, 3> corner;
  float from_sign = 1, to_sign = 1;
};

/// Triangles that read the texture through one sampler.
struct Patch {
  Sampling sampling;
  std::vector<PlacedTriangle> triangles;
  std::vector<TurnedFrames> frames;  ///< [triangle] for normals and directions, else empty
};

struct Painted {
  Image image;
  std::vector<std::uint8_t> is_covered;  ///< [texel]: a triangle has a sample there
};

/// Each texel is the mean of samples in its square, in linear light for colours; as many along each
/// axis as texels of the old image lie under it, up to a bound, beyond which they are read from the
/// mip chain. Only samples within triangles count. Throws Error{cancelled}.
Painted resample(const Texture& texture, std::span<const Patch> patches, const Size& size,
                 Content content, const std::stop_token& stop);

/// Gives every uncovered texel the colour of a nearest covered one. Throws Error{cancelled}.
void dilate(Painted& painted, const std::stop_token& stop);

/// How many times as wide and high as `page` a texture must be to have at least as many texels,
/// along every direction, as the old image of the size `old` has on all but the twentieth of its
/// area that needs most. Throws Error{cancelled}.
double scale_that_keeps_detail(std::span<const Patch> patches, const Size& page, const Size& old,
                               const std::stop_token& stop);

}  // namespace unwrapd::texture
