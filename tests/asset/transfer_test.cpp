// Textures that are transferred: what the document has then, and what the images show.
#include "tests/asset/transfer_samples.hpp"

namespace unwrapd::asset::test {
namespace {

TEST(Transfer, PaintsTheImageForTheNewLayout) {
  const Image old = chart_of_colours(kSide);
  for (const Codec codec : {Codec::png, Codec::webp}) {
    const Asset asset = read_file(textured(file_of(old, codec)).glb(), kTransfer);
    EXPECT_EQ(asset.texcoord(), 0);
    EXPECT_EQ(codes_of_transfer(asset), std::vector{NoteCode::textures_transferred});
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

TEST(Transfer, FillsTheRestOfThePageFromTheNearestTexels) {
  const Image old = constant(8, {50, 100, 150});
  const Written now = written(read_file(textured(file_of(old)).glb(), kTransfer), 0.5);
  EXPECT_EQ(now.images[0].rgba, constant(kSide, {50, 100, 150}).rgba);
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

TEST(Transfer, TurnsDirectionsOfAnisotropyOnAMirroredLayout) {
  Builder b = textured(file_of(constant(4, {255, 128, 70})));  // along the tangent, strength 70
  const std::size_t uv = b.add("VEC2", 5126, {1, 1, 0, 1, 0, 0, 1, 0});
  b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv;
  b.json["extensionsUsed"] = {"KHR_materials_anisotropy"};
  b.json["materials"] = {
      {{"extensions",
        {{"KHR_materials_anisotropy",
          {{"anisotropyRotation", 0.5}, {"anisotropyTexture", {{"index", 0}}}}}}}}};
  const Written now = written(read_file(b.glb(), kTransfer));
  // Before: U along -X, V along +Y of space; so the material turns -X by 0.5 towards +Y.
  const Vec2 space(-std::cos(0.5), std::sin(0.5));
  // After: U along -Y, V along +X. The material turns by 0.5 from U towards V again.
  const Vec2 read(-space.y(), space.x());
  const Vec2 turned_back(std::cos(0.5) * read.x() + std::sin(0.5) * read.y(),
                         -std::sin(0.5) * read.x() + std::cos(0.5) * read.y());
  EXPECT_NEAR(now.images[0].at(5, 5)[0], 127.5 * (1 + turned_back.x()), 2);
  EXPECT_NEAR(now.images[0].at(5, 5)[1], 127.5 * (1 + turned_back.y()), 2);
  EXPECT_NEAR(now.images[0].at(5, 5)[2], 70, 1);
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

TEST(Transfer, KeepsSixteenBits) {
  Image old = texture::blank_image({kSide, kSide}, true);
  for (std::size_t i = 0; i < old.deep.size(); ++i)
    old.deep[i] = static_cast<std::uint16_t>(i % 4 == 3 ? 0xffff : 257 * (i % 255) + 1);
  const Written now = written(read_file(textured(file_of(old)).glb(), kTransfer));
  ASSERT_EQ(now.images.size(), 1U);
  ASSERT_TRUE(now.images[0].is_deep());
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_EQ(now.images[0].deep[now.images[0].index(x, y) + c],
                  old.deep[old.index(kSide - 1 - y, x) + c]);  // as of old_texel()
}

TEST(Transfer, PaintsAPageThatIsNotSquare) {
  const Image old = chart_of_colours(kSide, 2 * kSide);
  AssetOptions options = kTransfer;
  options.page = {2 * kSide, kSide};
  const Asset asset = read_file(textured(file_of(old)).glb(), options);
  const Written now = written(asset);
  ASSERT_EQ(now.images[0].width, 2 * kSide);
  ASSERT_EQ(now.images[0].height, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < 2 * kSide; ++x)
      for (int c = 0; c < 4; ++c)
        EXPECT_EQ(now.images[0].at(x, y)[c], old_texel(old, x, y)[c]) << x << ' ' << y;
  options.page = {kSide, kSide / 2};
  const Asset dense = read_file(textured(file_of(old)).glb(), options);
  const std::string note = side_effects(dense, quarter_turn(dense), Format::glb).at(0).text;
  EXPECT_NE(note.find("from 16 x 32 to 32 x 16"), std::string::npos) << note;
}

TEST(Transfer, ASideKeepsTheDetailAndTheNoteTellsIt) {
  const Asset asset = read_file(textured(file_of(chart_of_colours(3 * kSide))).glb(), kTransfer);
  EXPECT_EQ(written(asset).images[0].width, 4 * kSide);
  const auto notes = side_effects(asset, quarter_turn(asset), Format::glb);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].text.find("from 48 x 48 to 64 x 64"), std::string::npos) << notes[0].text;
}

TEST(Transfer, TakesAnImageThatWasSentBesideTheDocument) {
  const Image old = chart_of_colours(kSide);
  Builder b = textured("");
  b.json["images"][0] = {{"uri", "wood.png"}, {"name", "wood"}};
  const std::string document = b.gltf();
  const std::map<std::string, std::string> parts = {{"wood.png", file_of(old)}};
  const Asset asset = read(input_of(document, parts), {}, kTransfer);
  const Written now = written(asset);
  ASSERT_EQ(now.images.size(), 1U);
  EXPECT_FALSE(now.json["images"][0].contains("uri"));
  EXPECT_EQ(now.json["images"][0]["name"], "wood");
  EXPECT_EQ(now.images[0].at(2, 3)[0], old_texel(old, 2, 3)[0]);
}

TEST(Transfer, FollowsTheMaterialsOfVariants) {
  Builder b = textured(file_of(chart_of_colours(kSide)));
  b.json["textures"].push_back({{"source", add_image(b, file_of(constant(4, {9, 90, 200})))}});
  b.json["materials"].push_back({{"emissiveTexture", {{"index", 1}}}});
  b.json["extensionsUsed"] = {"KHR_materials_variants"};
  b.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "other"}}};
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  const Written now = written(read_file(b.glb(), kTransfer));
  ASSERT_EQ(now.images.size(), 2U);
  EXPECT_EQ(now.json["materials"].size(), 2U);
  const int texture = now.json["materials"][1]["emissiveTexture"]["index"];
  const int image = now.json["textures"][static_cast<std::size_t>(texture)]["source"];
  EXPECT_EQ(now.images[static_cast<std::size_t>(image)].width, kSide);
  EXPECT_EQ(now.images[static_cast<std::size_t>(image)].at(7, 7)[2], 200);
}

TEST(Transfer, HasNoEffectWhereNothingIsSampled) {
  EXPECT_EQ(codes_of_transfer(read_file(square().glb(), kTransfer)),
            std::vector{NoteCode::option_unused});
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
