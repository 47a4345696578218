#pragma once
// Reads and writes image files through libpng, libjpeg-turbo and libwebp.

#include <stop_token>
#include <string>
#include <string_view>

#include "core/texture/image.hpp"

namespace unwrapd::texture {

/// "image/png", "image/jpeg" or "image/webp".
std::string_view media_type(Codec codec);

/// Reads the head alone and allocates nothing of the image's size. Throws Error: unsupported_image
/// for KTX2, AVIF, DDS and other files, an animation, or CMYK; malformed_image; too_much_memory for
/// a side beyond kMaxSide.
ImageHead head_of(const ImageFile& file);

/// The most bytes that decode() takes at once, with the decoder's own.
std::size_t decoding_bytes(const ImageHead& head);

/// head: of the same file. Channels keep their stored values: profiles and gamma are ignored, as
/// glTF asks. Throws Error{malformed_image}, Error{cancelled}.
Image decode(const ImageFile& file, const ImageHead& head, const std::stop_token& stop);

/// A file of head's codec; head's alpha and grey tell which channels are written. A PNG has the
/// bits of the image; of another codec it must have 8. JPEG and lossy WebP are written at
/// quality 95. Throws Error{cancelled}.
std::string encode(const Image& image, const ImageHead& head, const std::stop_token& stop);

}  // namespace unwrapd::texture
