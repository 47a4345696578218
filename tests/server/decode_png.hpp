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
  header.format = PNG_FORMAT_RGB;
  figure::Image image{.width = static_cast<int>(header.width),
                      .height = static_cast<int>(header.height),
                      .rgb = std::vector<std::uint8_t>(PNG_IMAGE_SIZE(header))};
  if (png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr) == 0) return {};
  return image;
}

}  // namespace unwrapd::server
