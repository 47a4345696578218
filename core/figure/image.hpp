#pragma once
// A picture in memory.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace unwrapd::figure {

using Rgb = std::array<std::uint8_t, 3>;  ///< sRGB

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;         ///< 3 * width * height, rows from the top, sRGB
  std::vector<std::uint8_t> alpha = {};  ///< width * height, 0: transparent; empty: all opaque

  [[nodiscard]] Rgb at(int x, int y) const {
    const std::size_t k = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x));
    return {rgb[k], rgb[k + 1], rgb[k + 2]};
  }
};

/// Bounds of a picture's side, pixels, and what is drawn when nobody asks for another.
inline constexpr int kMinImageSize = 64;
inline constexpr int kMaxImageSize = 4096;
inline constexpr int kDefaultImageSize = 1024;

/// "#rrggbb".
std::string hex(const Rgb& colour);

}  // namespace unwrapd::figure
