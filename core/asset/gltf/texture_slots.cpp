#include "core/asset/gltf/texture_slots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "core/asset/gltf/material_textures.hpp"
#include "core/asset/gltf/materials.hpp"
#include "core/asset/gltf/uris.hpp"

namespace unwrapd::asset {
namespace {

using texture::Content;
using texture::Wrap;

constexpr std::array<std::string_view, 7> kColours = {"baseColorTexture",
                                                      "emissiveTexture",
                                                      "diffuseTexture",
                                                      "sheenColorTexture",
                                                      "specularColorTexture",
                                                      "specularGlossinessTexture",
                                                      "diffuseTransmissionColorTexture"};
constexpr std::array<std::string_view, 2> kNormals = {"normalTexture", "clearcoatNormalTexture"};
constexpr std::string_view kAnisotropy = "anisotropyTexture";
constexpr std::string_view kPackedNormals = "normalRoughnessMetallicTexture";

Content content_of(const std::string& key) {
  if (std::ranges::find(kColours, key) != kColours.end()) return Content::colour;
  if (std::ranges::find(kNormals, key) != kNormals.end()) return Content::normals;
  return key == kAnisotropy ? Content::directions : Content::values;
}

/// An element of a list of the document, or an error of what refers to it.
Node element(const Gltf& gltf, std::string_view list, std::size_t number) {
  const Node elements = Node(gltf.json).at(list);
  if (number >= elements.array_size())
    fail(ErrorCode::malformed_gltf, elements.place().at(number),
         "a reference leads to no entry; export the asset again");
  const Node found = elements.at(number);
  found.expect_object();
  return found;
}

Wrap wrap_of(const Node& sampler, std::string_view key) {
  constexpr std::size_t kClamp = 33071, kMirror = 33648, kRepeat = 10497;
  const std::size_t mode = sampler.number(key, kRepeat);
  if (mode == kClamp) return Wrap::clamp;
  return mode == kMirror ? Wrap::mirror : Wrap::repeat;
}

texture::Sampling sampling_of(const Gltf& gltf, const Node& texture) {
  const auto number = texture.find("sampler");
  if (!number) return {};
  const Node sampler = element(gltf, "samplers", number->number());
  constexpr std::size_t kNearest = 9728, kLinear = 9729;
  return {wrap_of(sampler, "wrapS"), wrap_of(sampler, "wrapT"),
          sampler.number("magFilter", kLinear) == kNearest};
}

double number_at(const Json& object, const char* key, std::size_t k, double otherwise) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  const Json* value = &*found;
  if (value->is_array() && k < value->size()) value = &(*value)[k];
  return value->is_number() ? value->get<double>() : otherwise;
}

/// Translation * rotation * scale; a positive angle turns as in the extension's examples.
TextureMapping mapping_of(const Json& texture_info, const texture::Sampling& sampling) {
  TextureMapping mapping{.sampling = sampling};
  const Json* transform = transform_of(texture_info);
  if (transform == nullptr) return mapping;
  const double angle = number_at(*transform, "rotation", 0, 0);
  const double c = std::cos(angle), s = std::sin(angle);
  const double x = number_at(*transform, "scale", 0, 1), y = number_at(*transform, "scale", 1, 1);
  mapping.rows = {{{c * x, s * y, number_at(*transform, "offset", 0, 0)},
                   {-s * x, c * y, number_at(*transform, "offset", 1, 0)}}};
  return mapping;
}

double turn_of(const Json& material) {
  const Json* anisotropy = &material;
  for (const char* name : {"extensions", "KHR_materials_anisotropy"}) {
    const auto found = anisotropy->find(name);
    if (found == anisotropy->end() || !found->is_object()) return 0;
    anisotropy = &*found;
  }
  return number_at(*anisotropy, "anisotropyRotation", 0, 0);
}

std::string extensions_of(const Node& texture) {
  const auto extensions = texture.find("extensions");
  std::string names;
  if (extensions && extensions->json().is_object())
    for (const auto& [name, value] : extensions->json().items())
      names += (names.empty() ? "" : ", ") + name;
  return names;
}

}  // namespace

Vec2 TextureMapping::operator()(const Vec2& uv) const {
  return {rows[0][0] * uv.x() + rows[0][1] * uv.y() + rows[0][2],
          rows[1][0] * uv.x() + rows[1][1] * uv.y() + rows[1][2]};
}

std::size_t source_image(const Gltf& gltf, std::size_t texture) {
  const Node node = element(gltf, "textures", texture);
  if (const auto source = node.find("source")) return source->number();
  if (const auto extensions = node.find("extensions"))
    if (const auto webp = extensions->find(kWebpExtension))
      if (const auto source = webp->find("source")) return source->number();
  const std::string names = extensions_of(node);
  fail(ErrorCode::unsupported_image, node.place(),
       names.empty() ? "the texture has no image; export the asset again"
                     : "the texture has its image in " + names +
                           " alone (KTX2, for KHR_texture_basisu), which textures=transfer cannot "
                           "resample; add a PNG, JPEG or WebP, or leave textures out");
}

std::vector<TextureSlot> slots_of(const Gltf& gltf, std::size_t material, Pace& pace) {
  std::vector<TextureSlot> slots;
  const Node node = element(gltf, "materials", material);
  for_each_texture(node.json(), pace, [&](const std::string& key, const Json& info) {
    if (set_name(texcoord_of(info)) != gltf.texcoord) return;
    if (key == kPackedNormals)
      fail(ErrorCode::unsupported_image, node.place(),
           "the material packs normals with other numbers (MSFT_packing_normalRoughnessMetallic), "
           "which textures=transfer cannot turn; remove that extension");
    TextureSlot slot;
    slot.content = content_of(key);
    slot.texture = Node(info, node.place().at(key)).at("index").number();
    slot.image = source_image(gltf, slot.texture);
    slot.mapping = mapping_of(info, sampling_of(gltf, element(gltf, "textures", slot.texture)));
    if (key == kAnisotropy) slot.mapping.turn = turn_of(node.json());
    slots.push_back(slot);
  });
  return slots;
}

texture::ImageFile image_file(const Gltf& gltf, std::size_t image, std::string& storage) {
  const Node node = element(gltf, "images", image);
  const std::string where = node.place().pointer();
  if (const auto number = node.find("bufferView")) {
    const View& view = gltf.views[number->index(gltf.views.size(), "bufferViews")];
    return {std::string_view(gltf.buffers[view.buffer]).substr(view.offset, view.length), where};
  }
  if (const auto sent = gltf.sent_images.find(image); sent != gltf.sent_images.end())
    return {sent->second, where};
  const Node uri = node.at("uri");
  if (!uri.text().starts_with("data:"))
    fail(ErrorCode::missing_buffer, uri.place(),
         "the image was not sent, and textures=transfer needs it; add it as a part of the request "
         "with this file name, or send a GLB");
  storage = data_uri_bytes(uri, gltf.stop);
  return {storage, where};
}

void check_textures(const Gltf& gltf) {
  Pace pace(gltf.stop);
  std::set<std::size_t> materials, images;
  for (const Primitive& primitive : gltf.primitives)
    if (primitive.has_triangles && has_set(gltf, primitive, gltf.texcoord))
      for_each_material(json_of(gltf.json, primitive),
                        [&](const Json& number) { materials.insert(number.get<std::size_t>()); });
  for (const std::size_t material : materials)
    for (const TextureSlot& slot : slots_of(gltf, material, pace)) images.insert(slot.image);
  for (const std::size_t image : images) {
    std::string storage;
    const texture::ImageFile file = image_file(gltf, image, storage);
    const texture::ImageHead head = texture::head_of(file);
    const int least = std::max(gltf.transfer->page.width, gltf.transfer->page.height);
    if (head.codec == texture::Codec::webp && least > texture::kMaxWebpSide)
      throw Error(ErrorCode::unsupported_image,
                  "a WebP image has at most 16383 texels a side; lower the resolution or convert "
                  "the image to PNG",
                  file.where);
    if (texture::decoding_bytes(head) > gltf.transfer->max_bytes / 2)
      throw Error(ErrorCode::too_much_memory,
                  "the image takes more memory than a job may; send a smaller one", file.where);
  }
}

}  // namespace unwrapd::asset
