#pragma once
// The functions of codec.hpp for each library.

#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "core/texture/image.hpp"

namespace unwrapd::texture {

ImageHead png_head(const ImageFile& file);
Image decode_png(const ImageFile& file, const ImageHead& head, const std::stop_token& stop);
std::string encode_png(const Image& image, const ImageHead& head, const std::stop_token& stop);

ImageHead jpeg_head(const ImageFile& file);
Image decode_jpeg(const ImageFile& file, const ImageHead& head, const std::stop_token& stop);
std::string encode_jpeg(const Image& image, const ImageHead& head, const std::stop_token& stop);

ImageHead webp_head(const ImageFile& file);
Image decode_webp(const ImageFile& file, const ImageHead& head, const std::stop_token& stop);
std::string encode_webp(const Image& image, const ImageHead& head, const std::stop_token& stop);

inline constexpr int kQuality = 95;  // of lossy files

/// An image of the head's size, all zero.
inline Image blank(const ImageHead& head) {
  return blank_image({head.width, head.height}, head.is_deep);
}

[[noreturn]] inline void refuse_broken(const ImageFile& file, const std::string& format) {
  throw Error(ErrorCode::malformed_image,
              "the " + format + " image is broken or incomplete; export the asset again",
              file.where);
}

}  // namespace unwrapd::texture
