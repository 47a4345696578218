#pragma once
// Images in memory and in files. All work is on four channels, of eight bits each or of sixteen.

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
  bool is_deep = false;     ///< 16 bits a channel: some PNGs
};

/// Rows from the top, 4 values a texel; grey images have three equal channels. The values are in
/// rgba, or where they have 16 bits in deep; the other is empty.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  std::vector<std::uint16_t> deep = {};

  [[nodiscard]] bool is_deep() const { return !deep.empty(); }
  /// Of the first value of a texel.
  [[nodiscard]] std::size_t index(int x, int y) const {
    return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x));
  }
  [[nodiscard]] const std::uint8_t* at(int x, int y) const { return rgba.data() + index(x, y); }
};

/// All zero.
inline Image blank_image(const Size& size, bool is_deep) {
  const std::size_t values =
      4 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  Image image{size.width, size.height, {}};
  if (is_deep)
    image.deep.resize(values);
  else
    image.rgba.resize(values);
  return image;
}

}  // namespace unwrapd::texture
