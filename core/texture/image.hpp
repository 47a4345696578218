#pragma once
// Images in memory and in files. All work is on eight bits a channel, four channels.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::texture {

inline constexpr int kMaxSide = 16384;      ///< texels; no larger image is decoded
inline constexpr int kMaxWebpSide = 16383;  ///< texels; the format has no room for more

/// In texels.
struct Size {
  int width = 0, height = 0;
};

enum class Codec { png, jpeg, webp };

/// An image file. where: its place in the asset, for errors.
struct ImageFile {
  std::string_view bytes;
  std::string where;
};

/// What a file says of its image before it is decoded.
struct ImageHead {
  Codec codec = Codec::png;
  int width = 0, height = 0;  ///< in [1, kMaxSide]
  bool has_alpha = false;
  bool is_grey = false;
  bool is_lossless = true;  ///< of a WebP; a PNG always is, a JPEG never
};

/// rgba: rows from the top, 4 bytes a texel; grey images have three equal channels.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x));
  }
};

}  // namespace unwrapd::texture
