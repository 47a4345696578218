#pragma once
// PNG as libpng reads it: the tests' judge of what the server writes.

#include <png.h>

#include <string>

#include "core/figure/image.hpp"

namespace unwrapd::server {

inline constexpr const char* kSignature = "\x89PNG\r\n\x1a\n";

/// Reads a PNG by libpng; an empty picture when it is none.
inline figure::Image decode_png(const std::string& bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) == 0) return {};
  const bool has_alpha = (header.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  header.format = PNG_FORMAT_RGBA;
  figure::Image image{.width = static_cast<int>(header.width),
                      .height = static_cast<int>(header.height),
                      .rgb = {}};
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(header));
  if (png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr) == 0) return {};
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    if (k % 4 < 3) image.rgb.push_back(pixels[k]);
    if (k % 4 == 3 && has_alpha) image.alpha.push_back(pixels[k]);
  }
  return image;
}

}  // namespace unwrapd::server
