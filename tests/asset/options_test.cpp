// What a user asks of the document: which set, which primitives, which encoding.
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

std::vector<double> numbers(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(i) / 64;
  return values;
}

/// A grid with UVs, tangents and a material that moves its textures.
Builder painted() {
  Builder b = grid(3);  // 16 vertices
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = b.add("VEC2", 5126, numbers(32));
  attributes["TANGENT"] = b.add("VEC4", 5126, std::vector<double>(64, 0.5));
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json["textures"] = {Json::object()};
  b.json["materials"] = Json::parse(R"([{"name": "paint", "pbrMetallicRoughness": {
    "baseColorTexture": {"index": 0, "extensions": {
      "KHR_texture_transform": {"scale": [2, 4], "offset": [0.5, 0]}}}}}])");
  b.json["extensionsUsed"] = {"KHR_texture_transform"};
  return b;
}

Json first_primitive(const std::string& file) {
  return json_of(file)["meshes"][0]["primitives"][0];
}

std::vector<double> first_uv(const std::string& file, const std::string& set) {
  return read_naively(file)[0].faces[0].at(set)[0];
}

std::string answer(const std::string& file, const AssetOptions& options) {
  const Asset asset = read_file(file, options);
  return write(asset, split_everywhere(asset), Format::glb);
}

TEST(Texcoord, WritesTheSetThatIsNamedAndLeavesTheOthers) {
  const std::string file = painted().glb();
  const std::string light = answer(file, {.texcoord = 1, .compression = Compression::none});
  const auto before = read_naively(file), after = read_naively(light);
  for (std::size_t t = 0; t < before[0].faces.size(); ++t)
    for (const char* kept : {"POSITION", "TEXCOORD_0", "TANGENT"})
      EXPECT_EQ(after[0].faces[t].at(kept), before[0].faces[t].at(kept));
  EXPECT_TRUE(after[0].faces[0].contains("TEXCOORD_1"));
  EXPECT_EQ(json_of(light)["materials"], json_of(file)["materials"]);
}

TEST(Texcoord, FillsTheSetsBelowThatAreMissing) {
  const AssetOptions third{.texcoord = 2, .compression = Compression::none};
  const Asset asset = read_file(square().glb(), third);
  const std::string file = answer(square().glb(), third);
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_1"})
    EXPECT_EQ(first_uv(file, set), first_uv(file, "TEXCOORD_2"));
  EXPECT_EQ(side_effects(asset, split_nowhere(asset), Format::glb).size(), 1U);
}

TEST(Texcoord, MakesTangentsAnewAndTakesTransformsOfReplacedUvsAway) {
  const std::string file = answer(painted().glb(), kPlain);
  EXPECT_TRUE(first_primitive(file)["attributes"].contains("TANGENT"));
  const Json texture = json_of(file)["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  EXPECT_EQ(texture, Json({{"index", 0}}));
  const Asset asset = read_file(painted().glb());
  EXPECT_EQ(side_effects(asset, split_nowhere(asset), Format::glb).size(), 3U);
  EXPECT_EQ(json_of(file)["accessors"].size(), 4U);  // of the old tangents nothing is left
}

const Json kPlainTexture = {{"index", 0}};

const Json& colour_of(const Json& document, std::size_t material) {
  return document.at("materials").at(material).at("pbrMetallicRoughness").at("baseColorTexture");
}

TEST(Texcoord, CopiesAMaterialThatAPrimitiveWhichStaysHasToo) {
  Builder b = painted();
  b.json["meshes"][0]["primitives"].push_back(b.json["meshes"][0]["primitives"][0]);
  AssetOptions first = kPlain;
  first.primitives = {"/meshes/0/primitives/0"};
  const Json after = json_of(answer(b.glb(), first));
  const Json& primitives = after["meshes"][0]["primitives"];
  EXPECT_EQ(primitives[1]["material"], 0);
  EXPECT_EQ(after["materials"][0], b.json["materials"][0]);
  EXPECT_EQ(primitives[0]["material"], 1);
  EXPECT_EQ(colour_of(after, 1), kPlainTexture);
  EXPECT_EQ(after["materials"].size(), 2U);
}

TEST(Texcoord, TakesTransformsAwayFromTheMaterialsOfVariants) {
  Builder b = painted();
  b.json["materials"].push_back(b.json["materials"][0]);
  b.json["materials"].push_back(b.json["materials"][0]);  // no primitive has this one
  b.json["extensionsUsed"].push_back("KHR_materials_variants");
  b.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "other"}}};
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  const Json after = json_of(answer(b.glb(), kPlain));
  EXPECT_EQ(colour_of(after, 0), kPlainTexture);
  EXPECT_EQ(colour_of(after, 1), kPlainTexture);
  EXPECT_EQ(after["materials"][2], b.json["materials"][2]);
}

TEST(Texcoord, IsNoLongerMovedByMorphTargets) {
  Builder b = painted();
  const std::size_t moves = b.add("VEC2", 5126, numbers(32));
  const std::size_t place = b.add("VEC3", 5126, numbers(48));
  b.json["meshes"][0]["primitives"][0]["targets"] = {{{"TEXCOORD_0", moves}, {"POSITION", place}},
                                                     {{"TEXCOORD_0", moves}}};
  const Asset asset = read_file(b.glb(), kPlain);
  const Json after = json_of(write(asset, split_everywhere(asset), Format::glb));
  const Json& primitive = after["meshes"][0]["primitives"][0];
  const Json& targets = primitive["targets"];
  ASSERT_EQ(targets.size(), 2U);
  EXPECT_FALSE(targets[0].contains("TEXCOORD_0"));
  EXPECT_TRUE(targets[0].contains("POSITION"));
  const auto accessor = [&](const Json& number) { return after["accessors"][number.get<int>()]; };
  const Json zeros = accessor(targets[1]["TEXCOORD_0"]);
  EXPECT_FALSE(zeros.contains("bufferView"));
  EXPECT_EQ(zeros["count"], accessor(primitive["attributes"]["POSITION"])["count"]);
  EXPECT_EQ(side_effects(asset, split_nowhere(asset), Format::glb).size(), 4U);
}

TEST(Texcoord, ReadsUvsAsTheTextureShowsThem) {
  Asset asset = read_file(painted().glb());
  read_uvs(asset);
  const Surface& surface = asset.surfaces()[0];
  ASSERT_EQ(surface.corner_uv.size(), surface.mesh.faces.size());
  const Index v = surface.mesh.faces[0][1];  // its UV is (2v, 2v + 1) / 64, V downwards
  EXPECT_EQ(surface.corner_uv[0][1], Vec2(2 * (2 * v / 64.0), 1 - 4 * ((2 * v + 1) / 64.0)));
}

TEST(Texcoord, OfAnObjIsTheFirst) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0.5 0\nvt 0 0.25\nf 1/1 2/2 3/3\n";
  Asset asset = read_file(obj);
  read_uvs(asset);
  EXPECT_EQ(asset.surfaces()[0].corner_uv[0][2], Vec2(0, 0.25));
  for (const AssetOptions& options : {AssetOptions{.texcoord = 1}, AssetOptions{.materials = {"a"}},
                                      AssetOptions{.primitives = {"/meshes/0/primitives/0"}}}) {
    try {
      read_file(obj, options);
      ADD_FAILURE() << "it was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_option);
    }
  }
}

TEST(Texcoord, OfAnObjMayHaveOneNumberACommentOrTwoLines) {
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5\nvt +.25 \\\n1 0 # and w\nvt one\nvt 1 nan\n"
      "f 1/1 2/2 3/3\nf 1/1 2/2 3/4\n";
  Asset asset = read_file(obj);
  read_uvs(asset);
  const std::vector<CornerUv>& uv = asset.surfaces()[0].corner_uv;
  EXPECT_EQ(uv[0][0], Vec2(0.5, 0));
  EXPECT_EQ(uv[0][1], Vec2(0.25, 1));
  EXPECT_FALSE(uv[0][2].allFinite());
  EXPECT_FALSE(uv[1][2].allFinite());
}

/// Two primitives over the same vertices, of different materials.
Builder two_materials() {
  Builder b = painted();
  b.json["meshes"][0]["primitives"].push_back(b.json["meshes"][0]["primitives"][0]);
  b.json["meshes"][0]["primitives"][1]["material"] = 1;
  b.json["meshes"][0]["primitives"][1]["indices"] = b.add("SCALAR", 5123, {0, 1, 5});
  b.json["materials"].push_back({{"name", "glass"}});
  return b;
}

TEST(Selection, LeavesTheRestAsItWas) {
  const std::string file = two_materials().glb();
  for (const AssetOptions& only :
       {AssetOptions{.compression = Compression::none, .materials = {"glass"}},
        AssetOptions{.compression = Compression::none, .primitives = {"/meshes/0/primitives/1"}}}) {
    const std::string done = answer(file, only);
    const auto before = read_naively(file), after = read_naively(done);
    EXPECT_EQ(after[0].faces, before[0].faces);
    EXPECT_NE(after[1].faces[0].at("TEXCOORD_0"), before[1].faces[0].at("TEXCOORD_0"));
    EXPECT_EQ(json_of(done)["materials"], json_of(file)["materials"]);
    EXPECT_EQ(read_file(file, only).surfaces()[0].mesh.face_count(), 1);
  }
}

TEST(Selection, NamesWhatTheAssetDoesNotHave) {
  std::string message;
  const std::string file = two_materials().glb();
  const auto where = [&](const AssetOptions& options) {
    try {
      read_file(file, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_option);
      message = error.what();
      return error.where();
    }
    return std::string("read");
  };
  EXPECT_EQ(where({.materials = {"glass", "wood"}}), "/materials/1");
  EXPECT_NE(message.find("give glass"), std::string::npos) << message;
  EXPECT_EQ(where({.primitives = {"/meshes/0/primitives/2"}}), "/primitives/0");
}

TEST(VertexMap, TellsOfEveryVertexWhatItCopies) {
  const std::string file = grid(3).glb();
  const Asset asset = read_file(file);
  const auto unwrapped = split_everywhere(asset);
  const auto maps = vertex_maps(asset, unwrapped, Format::glb);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0].where, "/meshes/0/primitives/0");
  EXPECT_EQ(maps[0].kept, 16);
  const Asset again = read_file(write(asset, unwrapped, Format::glb));
  const auto& before = asset.surfaces()[0].mesh.positions;
  const auto& after = again.surfaces()[0].mesh.positions;
  ASSERT_EQ(after.size(), 16 + maps[0].copies.size());
  for (std::size_t k = 0; k < maps[0].copies.size(); ++k)
    EXPECT_EQ(after[16 + k], before[static_cast<std::size_t>(maps[0].copies[k])]);
}

TEST(Compression, KeepsWhatCameIn) {
  for (const auto& [compression, extension] :
       {std::pair(Compression::draco, "KHR_draco_mesh_compression"),
        std::pair(Compression::meshopt, "EXT_meshopt_compression")}) {
    const std::string packed = answer(grid(8).glb(), {.compression = compression});
    EXPECT_EQ(json_of(packed)["extensionsRequired"], Json::array({extension}));
    const std::string kept = answer(packed, {.compression = Compression::keep});
    EXPECT_EQ(json_of(kept)["extensionsRequired"], Json::array({extension}));
    EXPECT_FALSE(json_of(answer(packed, kPlain)).contains("extensionsRequired"));
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
