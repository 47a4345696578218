#include "server/work/png_file.hpp"

#include <png.h>

#include <cstdint>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::server::work {

namespace {

/// Red, green, blue and alpha of each pixel in turn.
std::vector<std::uint8_t> with_alpha(const figure::Image& image) {
  std::vector<std::uint8_t> all;
  all.reserve(4 * image.alpha.size());
  for (std::size_t k = 0; k < image.alpha.size(); ++k) {
    const auto pixel = image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k);
    all.insert(all.end(), pixel, pixel + 3);
    all.push_back(image.alpha[k]);
  }
  return all;
}

}  // namespace

std::string encode_png(const figure::Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = image.alpha.empty() ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  const std::vector<std::uint8_t> interleaved = with_alpha(image);
  const std::vector<std::uint8_t>& pixels = image.alpha.empty() ? image.rgb : interleaved;
  // What cannot be compressed grows by less: 5 bytes a block of zlib, 12 a chunk.
  png_alloc_size_t size = pixels.size() + pixels.size() / 64 + 4096;
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
    throw Error(ErrorCode::internal, "The picture could not be written; ask for a smaller one.");
  bytes.resize(size);
  return bytes;
}

}  // namespace unwrapd::server::work
