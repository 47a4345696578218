#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>
#include <memory>

#include "core/base/cancel.hpp"
#include "core/texture/codecs.hpp"

namespace unwrapd::texture {
namespace {

constexpr std::size_t kPart = std::size_t{1} << 16;  // bytes between two looks at the stop
constexpr int kLossless = 2;                         // WebPBitstreamFeatures::format
constexpr int kLosslessLevel = 4;                    // of 0 (fast) to 9 (small)

const std::uint8_t* bytes_of(const ImageFile& file) {
  return reinterpret_cast<const std::uint8_t*>(file.bytes.data());
}

void require_written(bool holds) {
  if (!holds) throw Error(ErrorCode::internal, "A WebP image could not be written.");
}

/// Returns 0 to end encoding.
int goes_on(int /*percent*/, const WebPPicture* picture) {
  return is_cancelled(*static_cast<const std::stop_token*>(picture->user_data)) ? 0 : 1;
}

WebPConfig config_of(const ImageHead& head) {
  WebPConfig config;
  require_written(WebPConfigInit(&config) != 0);
  config.quality = kQuality;
  if (head.is_lossless) require_written(WebPConfigLosslessPreset(&config, kLosslessLevel) != 0);
  config.exact = 1;  // colours where alpha is 0
  return config;
}

class Picture {
 public:
  explicit Picture(const Image& image) {
    require_written(WebPPictureInit(&picture) != 0);
    WebPMemoryWriterInit(&bytes);
    picture.width = image.width;
    picture.height = image.height;
    picture.use_argb = 1;
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &bytes;
  }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  ~Picture() {
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&bytes);
  }

  WebPPicture picture{};
  WebPMemoryWriter bytes{};
};

}  // namespace

ImageHead webp_head(const ImageFile& file) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes_of(file), file.bytes.size(), &features) != VP8_STATUS_OK)
    refuse_broken(file, "WebP");
  if (features.has_animation != 0)
    throw Error(ErrorCode::unsupported_image,
                "the WebP image is an animation, which textures=transfer cannot resample; send a "
                "still image",
                file.where);
  return {.codec = Codec::webp,
          .width = features.width,
          .height = features.height,
          .has_alpha = features.has_alpha != 0,
          .is_lossless = features.format == kLossless};
}

Image decode_webp(const ImageFile& file, const ImageHead& head, const std::stop_token& stop) {
  Image image = blank(head);
  const std::unique_ptr<WebPIDecoder, decltype(&WebPIDelete)> decoder(
      WebPINewRGB(MODE_RGBA, image.rgba.data(), image.rgba.size(), 4 * image.width), WebPIDelete);
  VP8StatusCode status = VP8_STATUS_SUSPENDED;
  for (std::size_t end = 0; status == VP8_STATUS_SUSPENDED && end < file.bytes.size();) {
    throw_if_cancelled(stop);
    end = std::min(end + kPart, file.bytes.size());
    status = WebPIUpdate(decoder.get(), bytes_of(file), end);
  }
  if (status != VP8_STATUS_OK) refuse_broken(file, "WebP");
  return image;
}

std::string encode_webp(const Image& image, const ImageHead& head, const std::stop_token& stop) {
  const WebPConfig config = config_of(head);
  Picture made(image);
  made.picture.progress_hook = goes_on;
  made.picture.user_data = const_cast<std::stop_token*>(&stop);  // goes_on() only reads it
  const int stride = 4 * image.width;
  require_written((head.has_alpha ? WebPPictureImportRGBA : WebPPictureImportRGBX)(
                      &made.picture, image.rgba.data(), stride) != 0);
  const bool is_written = WebPEncode(&config, &made.picture) != 0;
  throw_if_cancelled(stop);
  require_written(is_written);
  return {reinterpret_cast<const char*>(made.bytes.mem), made.bytes.size};
}

}  // namespace unwrapd::texture
