#include "core/asset/gltf/images.hpp"

#include <array>
#include <string_view>

#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

struct Kind {
  std::size_t offset;
  std::string_view magic;
  std::string_view media_type;
};

constexpr std::array<Kind, 5> kKinds = {{{0, "\x89PNG\r\n", "image/png"},
                                         {0, "\xff\xd8\xff", "image/jpeg"},
                                         {8, "WEBP", "image/webp"},
                                         {4, "ftypavif", "image/avif"},
                                         {0, "\xabKTX 20\xbb", "image/ktx2"}}};

}  // namespace

std::string_view media_type(std::string_view image) {
  for (const Kind& kind : kKinds)
    if (image.size() >= kind.offset && image.substr(kind.offset).starts_with(kind.magic))
      return kind.media_type;
  return {};
}

void embed_images(const Gltf& gltf, Json& document, NewViews& views) {
  for (const auto& [number, bytes] : gltf.sent_images) {
    throw_if_cancelled(gltf.stop);
    if (media_type(bytes).empty()) continue;
    Json& image = document["images"][number];
    if (!image.contains("uri")) continue;  // a resampled one took its place
    image.erase("uri");
    image["mimeType"] = media_type(bytes);
    image["bufferView"] = views.add(bytes, 0, 0);
  }
}

FilesBeside images_beside(const Gltf& gltf) {
  const auto images = gltf.json.find("images");
  FilesBeside files;
  if (images == gltf.json.end() || !images->is_array()) return files;
  for (std::size_t i = 0; i < images->size(); ++i) {
    const Json& image = (*images)[i];
    const auto uri = image.is_object() ? image.find("uri") : image.end();
    if (uri == image.end() || !uri->is_string()) continue;
    const auto& text = uri->get_ref<const std::string&>();
    const auto sent = gltf.sent_images.find(i);
    const bool is_taken = sent != gltf.sent_images.end() && !media_type(sent->second).empty();
    if (is_taken || text.find(':') != std::string::npos) continue;  // data, or an address
    if (files.count++ == 0) files.first = text;
  }
  return files;
}

}  // namespace unwrapd::asset
