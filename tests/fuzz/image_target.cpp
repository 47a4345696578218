// Any bytes as an image: what is decoded has the size that its head told, and can be written and
// read again.
#include "core/texture/codec.hpp"
#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {
namespace {

constexpr int kMostTexels = 1 << 20;  // so that a run is short

void image(std::string_view bytes) {
  const texture::ImageFile file{bytes, ""};
  const texture::ImageHead head = texture::head_of(file);
  if (head.width > kMostTexels / head.height) return;
  const texture::Image image = texture::decode(file, head, {});
  const auto texels = static_cast<std::size_t>(head.width) * static_cast<std::size_t>(head.height);
  promise(image.rgba.size() == (head.is_deep ? 0 : 4 * texels) &&
              image.deep.size() == (head.is_deep ? 4 * texels : 0),
          "an image has the size of its head");
  const std::string written = texture::encode(image, head, {});
  const texture::ImageHead again = texture::head_of({written, ""});
  promise(again.codec == head.codec && again.width == head.width && again.height == head.height &&
              again.is_deep == head.is_deep,
          "our own image is read again");
}

std::vector<std::string> image_seeds() {
  texture::Image picture{9, 7, {}};
  for (int i = 0; i < 4 * 9 * 7; ++i)
    picture.rgba.push_back(static_cast<std::uint8_t>(i * i % 251));
  std::vector<std::string> seeds;
  for (const texture::Codec codec :
       {texture::Codec::png, texture::Codec::jpeg, texture::Codec::webp})
    for (const bool is_grey : {false, true})
      seeds.push_back(texture::encode(picture, {codec, 9, 7, is_grey, is_grey, is_grey}, {}));
  texture::Image deep = texture::blank_image({5, 4}, true);
  for (std::size_t i = 0; i < deep.deep.size(); ++i)
    deep.deep[i] = static_cast<std::uint16_t>(i * 4001);
  seeds.push_back(texture::encode(deep, {texture::Codec::png, 5, 4, true, false, true, true}, {}));
  return seeds;
}

}  // namespace

Target image_target() { return {"image", image, image_seeds}; }

}  // namespace unwrapd::fuzz
