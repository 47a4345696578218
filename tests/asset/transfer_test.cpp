// Textures that are transferred: what the document has then, and what the images show.
#include "core/texture/codec.hpp"
#include "core/texture/resample.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using texture::Codec;
using texture::Image;

constexpr int kSide = 16;
constexpr AssetOptions kTransfer = {.texcoord = TexcoordChoice::automatic,
                                    .compression = Compression::none,
                                    .textures = TextureMode::transfer,
                                    .resolution = kSide};

/// Every texel another colour.
Image chart_of_colours(int side) {
  Image image{side, side, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (const int value : {16 * x + 7, 16 * y + 3, (x * 7 + y * 13) % 256, 255})
        image.rgba.push_back(static_cast<std::uint8_t>(value));
  return image;
}

Image constant(int side, std::array<int, 3> rgb) {
  Image image{side, side, {}};
  for (int i = 0; i < side * side; ++i)
    for (const int value : {rgb[0], rgb[1], rgb[2], 255})
      image.rgba.push_back(static_cast<std::uint8_t>(value));
  return image;
}

std::string file_of(const Image& image, Codec codec = Codec::png) {
  return texture::encode(image, {codec, image.width, image.height, false, false, true}, {});
}

std::size_t add_image(Builder& b, const std::string& bytes) {
  b.json["images"].push_back({{"bufferView", b.add_view(bytes)}, {"mimeType", "image/png"}});
  return b.json["images"].size() - 1;
}

/// A unit square with an upright normal, the UVs of its positions, and this image as base colour.
Builder textured(const std::string& image) {
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
std::vector<UnwrappedSurface> quarter_turn(const Asset& asset) {
  std::vector<UnwrappedSurface> unwrapped;
  for (const Surface& surface : asset.surfaces()) {
    UnwrappedSurface& turned = unwrapped.emplace_back();
    turned.faces = surface.mesh.faces;
    for (Index v = 0; v < surface.mesh.vertex_count(); ++v) {
      const Vec3& p = surface.mesh.positions[static_cast<std::size_t>(v)];
      turned.source.push_back(v);
      turned.uv.emplace_back(1 - p.y(), p.x());
    }
  }
  return unwrapped;
}

std::vector<NoteCode> codes(const Asset& asset) {
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

Written written(const Asset& asset) {
  const std::string glb = write(asset, quarter_turn(asset), Format::glb);
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
const std::uint8_t* old_texel(const Image& old, int x, int y) {
  // Place (x, y), V down: 1 - v = 1 - y', u = 1 - y of space, so space is (1 - y', 1 - x').
  return old.at(kSide - 1 - y, x);
}

TEST(Transfer, PaintsTheImageForTheNewLayout) {
  const Image old = chart_of_colours(kSide);
  for (const Codec codec : {Codec::png, Codec::webp}) {
    const Asset asset = read_file(textured(file_of(old, codec)).glb(), kTransfer);
    EXPECT_EQ(asset.texcoord(), 0);
    EXPECT_EQ(codes(asset), std::vector{NoteCode::textures_transferred});
    const Written now = written(asset);
    ASSERT_EQ(now.images.size(), 1U);
    EXPECT_EQ(now.heads[0].codec, codec);
    ASSERT_EQ(now.images[0].width, kSide);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int c = 0; c < 4; ++c)
          EXPECT_EQ(now.images[0].at(x, y)[c], old_texel(old, x, y)[c]) << x << ' ' << y;
    const Json& sampler = now.json["samplers"][now.json["textures"][0]["sampler"].get<int>()];
    EXPECT_EQ(sampler, (Json{{"wrapS", 33071}, {"wrapT", 33071}}));
  }
}

TEST(Transfer, RespectsATransformAndRemovesIt) {
  const Image old = chart_of_colours(kSide);
  Builder b = textured(file_of(old));
  b.json["extensionsUsed"] = {"KHR_texture_transform"};
  // Of the extension's examples: the lower left quarter of the image, turned.
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
      {"KHR_texture_transform",
       {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}}}};
  b.json["samplers"] = {{{"magFilter", 9728}}};
  b.json["textures"][0]["sampler"] = 0;
  const Written now = written(read_file(b.glb(), kTransfer));
  EXPECT_FALSE(now.json["materials"][0].dump().find("KHR_texture_transform") != std::string::npos);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double u = (kSide - 1 - y + 0.5) / kSide, v = (x + 0.5) / kSide;  // in the mesh
      const int ox = int(v / 2 * kSide), oy = int((1 - u / 2) * kSide);
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(now.images[0].at(x, y)[c], old.at(ox, oy)[c]) << x << ' ' << y;
    }
}

TEST(Transfer, TurnsANormalMapWithItsFrames) {
  // Leaning along +X of space; the quarter turn puts +X of space along +V.
  Builder b = textured(file_of(chart_of_colours(kSide)));
  b.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
  b.json["images"] = {{{"bufferView", b.add_view(file_of(constant(4, {230, 128, 200})))},
                       {"mimeType", "image/png"}}};
  const Written now = written(read_file(b.glb(), kTransfer));
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      EXPECT_NEAR(now.images[0].at(x, y)[0], 128, 2);
      EXPECT_NEAR(now.images[0].at(x, y)[1], 230, 4);  // in the new frame +X is the bitangent
      EXPECT_NEAR(now.images[0].at(x, y)[2], 200, 4);
    }
}

TEST(Transfer, SharesOneImageAmongSlotsOfOneMeaning) {
  Builder b = textured(file_of(chart_of_colours(kSide)));
  Json& material = b.json["materials"][0];
  material["emissiveTexture"] = {{"index", 0}};
  EXPECT_EQ(written(read_file(b.glb(), kTransfer)).images.size(), 1U);
  material["occlusionTexture"] = {{"index", 0}};  // numbers, not colours
  const Written now = written(read_file(b.glb(), kTransfer));
  EXPECT_EQ(now.images.size(), 2U);
  EXPECT_EQ(now.json["materials"][0]["emissiveTexture"]["index"],
            now.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"]);
}

TEST(Transfer, GivesPrimitivesThatReadAnImageInTwoWaysMaterialsOfTheirOwn) {
  Builder b = textured(file_of(chart_of_colours(kSide)));
  Json other = b.json["meshes"][0]["primitives"][0];
  other["attributes"]["TEXCOORD_0"] = b.add("VEC2", 5126, {0, 0, 0, 0, 1, 0, 1, 1});
  b.json["meshes"][0]["primitives"].push_back(other);
  const Written now = written(read_file(b.glb(), kTransfer));
  EXPECT_EQ(now.images.size(), 2U);
  EXPECT_EQ(now.json["materials"].size(), 2U);
  const Json& primitives = now.json["meshes"][0]["primitives"];
  EXPECT_NE(primitives[0]["material"], primitives[1]["material"]);
}

TEST(Transfer, KeepsWhatOtherPrimitivesRead) {
  const Image old = chart_of_colours(kSide);
  Builder b = textured(file_of(old));
  Json other = b.json["meshes"][0]["primitives"][0];
  b.json["meshes"][0]["primitives"].push_back(other);
  AssetOptions first = kTransfer;
  first.primitives = {"/meshes/0/primitives/0"};
  const Written now = written(read_file(b.glb(), first));
  const Json& primitives = now.json["meshes"][0]["primitives"];
  EXPECT_EQ(primitives[1]["material"], 0);
  EXPECT_EQ(now.json["materials"][0], b.json["materials"][0]);
  ASSERT_EQ(now.images.size(), 2U);
  EXPECT_EQ(now.images[0].rgba, old.rgba);
}

TEST(Transfer, ASideKeepsTheDetailAndTheNoteTellsIt) {
  const Asset asset = read_file(textured(file_of(chart_of_colours(3 * kSide))).glb(), kTransfer);
  EXPECT_EQ(written(asset).images[0].width, 4 * kSide);
  const auto notes = side_effects(asset, quarter_turn(asset), Format::glb);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].text.find("from 48 x 48 to 64 x 64"), std::string::npos) << notes[0].text;
}

ErrorCode refusal(const std::string& file, const std::string& where,
                  const AssetOptions& options = kTransfer) {
  try {
    read_file(file, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), where);
    return error.code();
  }
  return ErrorCode::internal;
}

TEST(Transfer, RefusesImagesItCannotReadByName) {
  EXPECT_EQ(refusal(textured("\xabKTX 20\xbb\r\n\x1a\n").glb(), "/images/0"),
            ErrorCode::unsupported_image);
  EXPECT_EQ(refusal(textured("\x89PNG\r\n\x1a\n").glb(), "/images/0"), ErrorCode::malformed_image);
  Builder basisu = textured("");
  basisu.json["extensionsUsed"] = {"KHR_texture_basisu"};
  basisu.json["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  EXPECT_EQ(refusal(basisu.glb(), "/textures/0"), ErrorCode::unsupported_image);
  Builder beside = textured("");
  beside.json["images"][0] = {{"uri", "wood.png"}};
  EXPECT_EQ(refusal(beside.glb(), "/images/0/uri"), ErrorCode::missing_buffer);
  Builder dangling = textured("");
  dangling.json["textures"][0]["source"] = 9;
  EXPECT_EQ(refusal(dangling.glb(), "/images/9"), ErrorCode::malformed_gltf);
  EXPECT_EQ(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "/textures"),
            ErrorCode::invalid_option);
  for (const std::string& file : {basisu.glb(), beside.glb(), dangling.glb()})
    EXPECT_NO_THROW(read_file(file, {.texcoord = TexcoordChoice::automatic}));
}

TEST(Transfer, HasNoEffectWhereNothingIsSampled) {
  EXPECT_EQ(codes(read_file(square().glb(), kTransfer)), std::vector{NoteCode::option_unused});
}

TEST(Transfer, WorksOnACompressedAsset) {
  const Image old = chart_of_colours(kSide);
  for (const Compression compression : {Compression::draco, Compression::meshopt}) {
    const Asset plain =
        read_file(textured(file_of(old)).glb(), {.texcoord = 7, .compression = compression});
    AssetOptions options = kTransfer;
    options.compression = Compression::keep;
    const Asset asset = read_file(write(plain, quarter_turn(plain), Format::glb), options);
    const Written now = written(asset);
    ASSERT_EQ(now.images.size(), 1U);
    EXPECT_TRUE(now.json.contains("textures"));
    EXPECT_TRUE(now.json.contains("samplers"));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(now.images[0].at(5, 9)[c], old_texel(old, 5, 9)[c], 1);
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
