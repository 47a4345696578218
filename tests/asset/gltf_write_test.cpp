#include <cmath>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

/// Everything that a document can carry beside its triangles, around the given grid.
Builder torture() {
  Builder b = grid(3);  // 16 vertices
  std::vector<double> ramp;
  for (int i = 0; i < 64; ++i) ramp.push_back(i);
  const auto some = [&](std::size_t n) {
    return std::vector<double>(ramp.begin(), ramp.begin() + std::ptrdiff_t(n));
  };
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  Json& attributes = primitive["attributes"];
  attributes["NORMAL"] = b.add("VEC3", 5126, std::vector<double>(48, std::sqrt(1.0 / 3)));
  attributes["TEXCOORD_0"] = b.add("VEC2", 5123, some(32));
  attributes["TEXCOORD_1"] = b.add("VEC2", 5126, some(32));
  attributes["COLOR_0"] = b.add("VEC4", 5121, ramp);
  attributes["JOINTS_0"] = b.add("VEC4", 5121, std::vector<double>(64, 0));
  attributes["WEIGHTS_0"] = b.add("VEC4", 5126, std::vector<double>(64, 0.25));
  attributes["_ID"] = b.add("SCALAR", 5126, some(16));
  for (const char* normalized : {"TEXCOORD_0", "COLOR_0"})
    b.json["accessors"][attributes[normalized].get<std::size_t>()]["normalized"] = true;
  const std::size_t sparse_indices = b.add_view(std::string("\x03\0\x08\0", 4));
  const std::size_t sparse_values = b.add_view(std::string(24, '\x3f'));
  b.json["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 16},
       {"type", "VEC3"},
       {"extras", {{"kept", true}}},
       {"sparse",
        {{"count", 2},
         {"indices", {{"bufferView", sparse_indices}, {"componentType", 5123}}},
         {"values", {{"bufferView", sparse_values}}}}}});
  const std::size_t sparse = b.json["accessors"].size() - 1;
  primitive["targets"] = {{{"POSITION", sparse}}, {{"POSITION", b.add("VEC3", 5126, some(48))}}};
  b.json["meshes"][0]["weights"] = {0.5, 0.25};
  b.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"children", {1}}}, {{"name", "joint"}}};
  b.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", b.add("MAT4", 5126, some(16))}}};
  b.json["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}},
       {"samplers",
        {{{"input", b.add("SCALAR", 5126, {0, 1})}, {"output", b.add("VEC3", 5126, some(6))}}}}}};
  b.json["extras"] = {{"big", 9007199254740993LL},
                      {"f", 0.1234567890123456},
                      {"n", nullptr},
                      {"u", "\u00e9\u2713"},
                      {"~/", {{"deep", {1, {{"a", Json::object()}}}}}}};
  return b;
}

/// A document without what an answer may change: geometry's accessors, views and buffers.
Json rest_of(Json document) {
  for (const char* changed : {"accessors", "bufferViews", "buffers"}) document.erase(changed);
  for (Json& mesh : document["meshes"])
    for (Json& primitive : mesh["primitives"])
      for (const char* changed : {"attributes", "indices", "mode"}) primitive.erase(changed);
  return document;
}

std::string answer_to(const std::string& file, Format format = Format::glb) {
  const Asset asset = read_file(file);
  return write(asset, split_everywhere(asset), format);
}

TEST(GltfWrite, CarriesEverythingOverAtEverySeam) {
  const std::string file = torture().glb();
  for (const Format format : {Format::glb, Format::gltf}) {
    const std::string answer = answer_to(file, format);
    EXPECT_EQ(rest_of(json_of(answer)), rest_of(json_of(file)));
    expect_same_but_uv(read_naively(file), read_naively(answer));
  }
}

TEST(GltfWrite, ChangesNothingButTheUvsWhenNoVertexIsSplit) {
  const std::string file = grid(4).glb();
  const Asset asset = read_file(file);
  const std::string answer = write(asset, split_nowhere(asset), Format::glb);
  Json before = json_of(file);
  Json after = json_of(answer);
  EXPECT_EQ(after["accessors"].size(), before["accessors"].size() + 1);
  EXPECT_EQ(after["bufferViews"].size(), before["bufferViews"].size() + 1);
  after["accessors"].erase(2);
  after["bufferViews"].erase(2);
  after["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  after["buffers"] = before["buffers"];
  EXPECT_EQ(after, before);
  const std::string bin = grid(4).bin;
  EXPECT_NE(answer.find(bin), std::string::npos);
}

TEST(GltfWrite, KeepsTheNumbersOfWhatItReplaces) {
  const std::string file = torture().glb();
  const Json before = json_of(file);
  const Json after = json_of(answer_to(file));
  EXPECT_EQ(after["meshes"], before["meshes"]);
  EXPECT_EQ(after["accessors"].size(), before["accessors"].size());
  EXPECT_EQ(after["bufferViews"].size(), before["bufferViews"].size());
}

TEST(GltfWrite, LeavesOutTheBytesThatOnlyTheOldGeometryUsed) {
  const std::string once = answer_to(grid(20).glb());
  const std::string twice = answer_to(once);
  EXPECT_LT(twice.size(), once.size() + 200);
}

TEST(GltfWrite, AForeignExtensionKeepsOldAccessorsAndViewsInPlace) {
  Builder b = torture();
  b.json["extensionsUsed"] = {"ACME_points_at_accessors"};
  const std::string file = b.glb();
  const std::string answer = answer_to(file);
  const Json before = json_of(file);
  const Json after = json_of(answer);
  for (std::size_t i = 0; i < before["accessors"].size(); ++i)
    EXPECT_EQ(after["accessors"][i], before["accessors"][i]);
  for (std::size_t i = 0; i < before["bufferViews"].size(); ++i)
    EXPECT_EQ(after["bufferViews"][i], before["bufferViews"][i]);
  expect_same_but_uv(read_naively(file), read_naively(answer));
}

TEST(GltfWrite, WhatOthersUseAsWellStaysAsItIs) {
  Builder b = torture();
  const std::size_t id = b.json["meshes"][0]["primitives"][0]["attributes"]["_ID"];
  b.json["animations"][0]["samplers"][0]["input"] = id;
  b.add_primitive({{"POSITION", 0}})["mode"] = 0;  // points over the same positions
  const std::string file = b.glb();
  const std::string answer = answer_to(file);
  const Json before = json_of(file);
  const Json after = json_of(answer);
  EXPECT_EQ(after["accessors"][id]["count"], before["accessors"][id]["count"]);
  EXPECT_EQ(after["accessors"][0]["count"], before["accessors"][0]["count"]);
  EXPECT_EQ(after["meshes"][0]["primitives"][1], before["meshes"][0]["primitives"][1]);
}

TEST(GltfWrite, PrimitivesThatShareVerticesStillDo) {
  Builder b = grid(6);
  b.add_primitive({{"POSITION", 0}}, b.add("SCALAR", 5123, {0, 9, 3, 9, 20, 3}));
  b.add_primitive({{"POSITION", 0}}, b.add("SCALAR", 5123, {40, 41, 33}));
  const std::string file = b.glb();
  const std::string answer = answer_to(file);
  expect_same_but_uv(read_naively(file), read_naively(answer));
  const Json after = json_of(answer);
  const Json& primitives = after["meshes"][0]["primitives"];
  EXPECT_EQ(primitives[0]["attributes"], primitives[1]["attributes"]);
  EXPECT_EQ(primitives[0]["attributes"], primitives[2]["attributes"]);
}

TEST(GltfWrite, TheSameGeometryUnderOtherAttributesGetsTheSameUvs) {
  Builder b = grid(3);
  const std::vector<double> colors(48, 0.5);
  b.add_primitive({{"POSITION", 0}, {"COLOR_0", b.add("VEC3", 5126, colors)}}, 1);
  b.json["meshes"].push_back(
      {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}});
  const std::string file = b.glb();
  EXPECT_EQ(read_file(file).surfaces().size(), 1U);
  expect_same_but_uv(read_naively(file), read_naively(answer_to(file)));
}

TEST(GltfWrite, MeshesOverOneBufferSplitItWithoutHarmToEachOther) {
  Builder b = grid(6);
  for (const int first : {0, 9, 18}) {
    const double k = first;
    const std::size_t indices = b.add("SCALAR", 5123, {k, k + 1, k + 8, k, k + 8, k + 7});
    b.json["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", indices}}}}});
  }
  const std::string file = b.glb();
  EXPECT_EQ(read_file(file).surfaces().size(), 4U);
  expect_same_but_uv(read_naively(file), read_naively(answer_to(file)));
}

TEST(GltfWrite, StripsAndFansBecomeTrianglesOnlyWhenTheyMust) {
  for (const int mode : {5, 6}) {
    Builder b = square();
    Json& primitive = b.json["meshes"][0]["primitives"][0];
    primitive["mode"] = mode;
    primitive["indices"] = b.add("SCALAR", 5121, {0, 1, 2, 3});
    const std::string file = b.glb();
    const Asset asset = read_file(file);
    const Json kept = json_of(write(asset, split_nowhere(asset), Format::glb));
    EXPECT_EQ(kept["meshes"][0]["primitives"][0]["mode"], mode);
    const std::string answer = answer_to(file);
    EXPECT_EQ(json_of(answer)["meshes"][0]["primitives"][0]["mode"], 4);
    expect_same_but_uv(read_naively(file), read_naively(answer));
  }
}

TEST(GltfWrite, IndicesAreOfTheSmallestTypeThatHoldsThem) {
  const std::vector<std::pair<int, int>> expected = {{10, 5123}, {104, 5123}, {105, 5125}};
  for (const auto& [n, type] : expected) {  // 6 n^2 corners: 64,896 fit, 66,150 do not
    const Json after = json_of(answer_to(grid(n).glb()));
    EXPECT_EQ(after["accessors"][1]["componentType"], type) << n;
  }
}

TEST(GltfWrite, TheIndexThatRestartsAPrimitiveIsNeverUsed) {
  for (const int unused : {0, 1}) {
    Builder b;  // 21,845 faces over three vertices: split everywhere, the last index is 65534
    std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    if (unused > 0) points.insert(points.end(), {9, 9, 9});
    std::vector<double> corners;
    for (int i = 0; i < 21'845; ++i) corners.insert(corners.end(), {0, 1, 2});
    const std::size_t position = b.add("VEC3", 5126, points);
    b.add_primitive({{"POSITION", position}}, b.add("SCALAR", 5121, corners));
    const Json after = json_of(answer_to(b.glb()));
    EXPECT_EQ(after["accessors"][1]["componentType"], unused > 0 ? 5125 : 5123);
  }
}

TEST(GltfWrite, WhatIsKeptStaysAsAlignedAsItWas) {
  Builder b = grid(3);
  const std::size_t odd = b.add_view(std::string(8, 'x'));
  b.json["bufferViews"][odd]["byteOffset"] = b.bin.size() - 7;
  b.json["bufferViews"][odd]["byteLength"] = 3;
  b.json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", b.bin.size() - 4}, {"byteLength", 4}});
  b.json["images"] = {{{"bufferView", odd}, {"mimeType", "image/png"}},
                      {{"bufferView", odd + 1}, {"mimeType", "image/png"}}};
  const Json after = json_of(answer_to(b.glb()));
  const Json& views = after["bufferViews"];
  EXPECT_EQ(
      views[after["images"][0]["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() %
          4,
      1U);
  EXPECT_EQ(
      views[after["images"][1]["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() %
          4,
      0U);
}

TEST(GltfWrite, SeveralBuffersBecomeOneUnlessTheyCarryMore) {
  Builder b = square();
  b.json["buffers"].push_back(
      {{"byteLength", 4}, {"uri", "data:application/octet-stream;base64,AQIDBA=="}});
  b.json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 4}});
  b.json["images"] = {{{"bufferView", 2}, {"mimeType", "image/png"}}};
  EXPECT_EQ(json_of(answer_to(b.glb()))["buffers"].size(), 1U);
  b.json["buffers"][1]["extras"] = "mine";
  const std::string file = b.glb();
  const std::string answer = answer_to(file);
  EXPECT_EQ(json_of(answer)["buffers"][1], json_of(file)["buffers"][1]);
  expect_same_but_uv(read_naively(file), read_naively(answer));
}

TEST(GltfWrite, AnswersAreTheSameBytesEveryTime) {
  const std::string file = torture().glb();
  EXPECT_EQ(answer_to(file), answer_to(file));
}

TEST(GltfWrite, AsObjItHasAnObjectAMeshAndReadsBackTheSame) {
  Builder b = torture();
  b.json["meshes"][0]["name"] = "a\nb";
  b.json["nodes"][0].erase("skin");
  b.json["meshes"].push_back(
      {{"primitives",
        {{{"attributes", {{"POSITION", b.add("VEC3", 5126, {0, 0, 9, 1, 0, 9, 0, 1, 9})}}}}}}});
  const Asset asset = read_file(b.glb());
  const std::string obj = write(asset, split_everywhere(asset), Format::obj);
  EXPECT_NE(obj.find("o a b\n"), std::string::npos);
  EXPECT_NE(obj.find("o mesh_1\n"), std::string::npos);
  const Asset again = read_file(obj);
  ASSERT_EQ(again.surfaces().size(), 1U);
  const TriMesh& mesh = again.surfaces()[0].mesh;
  ASSERT_EQ(mesh.face_count(), 19);
  std::size_t t = 0;
  for (const Surface& surface : asset.surfaces())
    for (const Triangle& face : surface.mesh.faces) {
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.positions[static_cast<std::size_t>(mesh.faces[t][k])],
                  surface.mesh.positions[static_cast<std::size_t>(face[k])]);
      ++t;
    }
}

}  // namespace
}  // namespace unwrapd::asset::test
