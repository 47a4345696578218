#pragma once
// A textured square whose textures are transferred, and what becomes of its images.

#include <array>
#include <string>
#include <vector>

#include "core/texture/codec.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {

using texture::Codec;
using texture::Image;

inline constexpr int kSide = 16;
inline const AssetOptions kTransfer = {.texcoord = TexcoordChoice::automatic,
                                       .compression = Compression::none,
                                       .textures = TextureMode::transfer,
                                       .page = {kSide, kSide}};

/// Every texel another colour, of 16 x 16.
inline Image chart_of_colours(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : {16 * x + 7, 16 * y + 3, (x * 7 + y * 13) % 256, 255})
        image.rgba.push_back(static_cast<std::uint8_t>(value));
  return image;
}

inline Image chart_of_colours(int side) { return chart_of_colours(side, side); }

inline Image constant(int side, std::array<int, 3> rgb) {
  Image image{side, side, {}};
  for (int i = 0; i < side * side; ++i)
    for (const int value : {rgb[0], rgb[1], rgb[2], 255})
      image.rgba.push_back(static_cast<std::uint8_t>(value));
  return image;
}

inline std::string file_of(const Image& image, Codec codec = Codec::png) {
  return texture::encode(image, {codec, image.width, image.height, false, false, true}, {});
}

inline std::size_t add_image(Builder& b, const std::string& bytes) {
  b.json["images"].push_back({{"bufferView", b.add_view(bytes)}, {"mimeType", "image/png"}});
  return b.json["images"].size() - 1;
}

/// A unit square with an upright normal, the UVs of its positions, and this image as base colour.
inline Builder textured(const std::string& image) {
  Builder b;
  const std::size_t position = b.add("VEC3", 5126, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  b.json["accessors"][position]["min"] = {0, 0, 0};
  b.json["accessors"][position]["max"] = {1, 1, 0};
  const std::size_t normal = b.add("VEC3", 5126, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const std::size_t uv = b.add("VEC2", 5126, {0, 1, 1, 1, 1, 0, 0, 0});
  b.add_primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}},
                  b.add("SCALAR", 5123, {0, 1, 2, 0, 2, 3}));
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["textures"] = {{{"source", add_image(b, image)}}};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  return b;
}

/// The square on the page turned by a quarter: (x, y) is at (1 - y, x), V pointing up.
/// scale: of the square, which stays at the lower left.
inline std::vector<UnwrappedSurface> quarter_turn(const Asset& asset, double scale = 1) {
  std::vector<UnwrappedSurface> unwrapped;
  for (const Surface& surface : asset.surfaces()) {
    UnwrappedSurface& turned = unwrapped.emplace_back();
    turned.faces = surface.mesh.faces;
    for (Index v = 0; v < surface.mesh.vertex_count(); ++v) {
      const Vec3& p = surface.mesh.positions[static_cast<std::size_t>(v)];
      turned.source.push_back(v);
      turned.uv.emplace_back(scale * (1 - p.y()), scale * p.x());
    }
  }
  return unwrapped;
}

inline std::vector<NoteCode> codes_of_transfer(const Asset& asset) {
  std::vector<NoteCode> found;
  for (const Note& note : side_effects(asset, quarter_turn(asset), Format::glb))
    found.push_back(note.code);
  return found;
}

/// The written document, and its images decoded.
struct Written {
  Json json;
  std::vector<Image> images;
  std::vector<texture::ImageHead> heads;
};

inline Written written(const Asset& asset, double scale = 1) {
  const std::string glb = write(asset, quarter_turn(asset, scale), Format::glb);
  Written result{json_of(glb), {}, {}};
  const std::string bin = glb.substr(glb.find("BIN") + 4);
  for (const Json& image : result.json["images"]) {
    const Json& view = result.json["bufferViews"][image["bufferView"].get<std::size_t>()];
    const std::string bytes = bin.substr(view.value("byteOffset", 0U), view["byteLength"]);
    const texture::ImageFile file{bytes, ""};
    result.heads.push_back(texture::head_of(file));
    result.images.push_back(texture::decode(file, result.heads.back(), {}));
  }
  return result;
}

/// The texel of the old image where the quarter turn shows it.
inline const std::uint8_t* old_texel(const Image& old, int x, int y) {
  // Place (x, y), V down: 1 - v = 1 - y', u = 1 - y of space, so space is (1 - y', 1 - x').
  return old.at(kSide - 1 - y, x);
}

}  // namespace unwrapd::asset::test
