#pragma once
// Small pictures and layouts for tests of core/texture.

#include <array>
#include <cmath>
#include <functional>

#include "core/texture/resample.hpp"

namespace unwrapd::texture::test {

using Rgba = std::array<int, 4>;

inline Image picture(int width, int height, const std::function<Rgba(int, int)>& colour) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : colour(x, y)) image.rgba.push_back(static_cast<std::uint8_t>(value));
  return image;
}

/// Every texel another colour, without a pattern.
inline Image noise(int width, int height) {
  unsigned state = 1;
  return picture(width, height, [&](int, int) {
    Rgba colour{};
    for (int& value : colour)
      value = static_cast<int>((state = state * 1664525U + 1013904223U) >> 24U);
    return colour;
  });
}

/// The same of 16 bits.
inline Image deep_noise(int width, int height) {
  Image image = blank_image({width, height}, true);
  unsigned state = 7;
  for (std::uint16_t& value : image.deep)
    value = static_cast<std::uint16_t>((state = state * 1664525U + 1013904223U) >> 16U);
  return image;
}

inline Rgba at(const Image& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return {p[0], p[1], p[2], p[3]};
}

/// The square [0, 1] x [0, 1] of the page as two triangles; from: where each point of it is read.
inline Patch page(const std::function<Eigen::Vector2f(float, float)>& from,
                  Sampling sampling = {}) {
  const auto triangle = [&](std::array<Eigen::Vector2f, 3> to) {
    PlacedTriangle placed{{}, to};
    for (std::size_t k = 0; k < 3; ++k) placed.from[k] = from(to[k].x(), to[k].y());
    return placed;
  };
  Patch patch{sampling, {}, {}};
  patch.triangles.push_back(triangle({{{0, 0}, {1, 0}, {1, 1}}}));
  patch.triangles.push_back(triangle({{{0, 0}, {1, 1}, {0, 1}}}));
  return patch;
}

inline Painted paint(const Image& image, const Patch& patch, const Size& size,
                     Content content = Content::colour) {
  return resample(Texture(image, content == Content::colour, {}), std::array{patch}, size, content,
                  {});
}

inline Painted paint(const Image& image, const Patch& patch, int side,
                     Content content = Content::colour) {
  return paint(image, patch, {side, side}, content);
}

}  // namespace unwrapd::texture::test
