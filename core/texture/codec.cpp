#include "core/texture/codec.hpp"

#include <array>

#include "core/base/error.hpp"
#include "core/texture/codecs.hpp"

namespace unwrapd::texture {
namespace {

struct Unsupported {
  std::size_t offset;
  std::string_view magic, name;
};

constexpr std::array<Unsupported, 5> kUnsupported = {{{0, "\xabKTX 20\xbb", "KTX2"},
                                                      {0, "\xabKTX 11\xbb", "KTX"},
                                                      {4, "ftypavif", "AVIF"},
                                                      {0, "DDS ", "DDS"},
                                                      {0, "GIF8", "GIF"}}};

bool has_magic(std::string_view bytes, std::size_t offset, std::string_view magic) {
  return bytes.size() >= offset && bytes.substr(offset).starts_with(magic);
}

[[noreturn]] void refuse_format(const ImageFile& file) {
  std::string name = "in an unknown format";
  for (const Unsupported& other : kUnsupported)
    if (has_magic(file.bytes, other.offset, other.magic)) name = std::string(other.name);
  throw Error(ErrorCode::unsupported_image,
              "the image is " + name +
                  ", which textures=transfer cannot resample; convert it to PNG, JPEG or WebP, or "
                  "leave textures out",
              file.where);
}

ImageHead any_head(const ImageFile& file) {
  if (has_magic(file.bytes, 0, "\x89PNG\r\n")) return png_head(file);
  if (has_magic(file.bytes, 0, "\xff\xd8\xff")) return jpeg_head(file);
  if (has_magic(file.bytes, 0, "RIFF") && has_magic(file.bytes, 8, "WEBP")) return webp_head(file);
  refuse_format(file);
}

}  // namespace

std::string_view media_type(Codec codec) {
  constexpr std::array<std::string_view, 3> kTypes = {"image/png", "image/jpeg", "image/webp"};
  return kTypes[static_cast<std::size_t>(codec)];
}

ImageHead head_of(const ImageFile& file) {
  const ImageHead head = any_head(file);
  if (head.width < 1 || head.height < 1) refuse_broken(file, "");
  if (head.width > kMaxSide || head.height > kMaxSide)
    throw Error(ErrorCode::too_much_memory,
                "the image is " + std::to_string(head.width) + " x " + std::to_string(head.height) +
                    " texels; at most " + std::to_string(kMaxSide) + " a side can be resampled",
                file.where);
  return head;
}

std::size_t decoding_bytes(const ImageHead& head) {
  const std::size_t texels =
      static_cast<std::size_t>(head.width) * static_cast<std::size_t>(head.height);
  if (head.codec == Codec::png) return texels * (head.is_deep ? 8 : 4);
  return texels * 12;  // progressive JPEG: 2 bytes a coefficient
}

Image decode(const ImageFile& file, const ImageHead& head, const std::stop_token& stop) {
  if (head.codec == Codec::png) return decode_png(file, head, stop);
  return head.codec == Codec::jpeg ? decode_jpeg(file, head, stop) : decode_webp(file, head, stop);
}

std::string encode(const Image& image, const ImageHead& head, const std::stop_token& stop) {
  if (head.codec == Codec::png) return encode_png(image, head, stop);
  return head.codec == Codec::jpeg ? encode_jpeg(image, head, stop)
                                   : encode_webp(image, head, stop);
}

}  // namespace unwrapd::texture
