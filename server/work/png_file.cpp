#include "server/work/png_file.hpp"

#include <png.h>

#include "core/base/error.hpp"

namespace unwrapd::server::work {

std::string encode_png(const figure::Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  // What cannot be compressed grows by less: 5 bytes a block of zlib, 12 a chunk.
  png_alloc_size_t size = image.rgb.size() + image.rgb.size() / 64 + 4096;
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0)
    throw Error(ErrorCode::internal, "The picture could not be written; ask for a smaller one.");
  bytes.resize(size);
  return bytes;
}

}  // namespace unwrapd::server::work
