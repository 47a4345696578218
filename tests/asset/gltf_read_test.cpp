#include <cmath>
#include <functional>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

/// The square's four corners in the faces' order.
std::vector<Vec3> corner_points(const Asset& asset) {
  std::vector<Vec3> points;
  for (const Surface& surface : asset.surfaces())
    for (const Triangle& face : surface.mesh.faces)
      for (const Index vertex : face)
        points.push_back(surface.mesh.positions[static_cast<std::size_t>(vertex)]);
  return points;
}

TEST(GltfRead, AllEncodingsOfASquareGiveTheSameFaces) {
  const std::vector<Vec3> expected = corner_points(read_file(square().glb()));
  ASSERT_EQ(expected.size(), 6U);
  for (const int type : {5121, 5123, 5125}) {
    Builder b = square();
    b.json["meshes"][0]["primitives"][0]["indices"] = b.add("SCALAR", type, {0, 1, 2, 0, 2, 3});
    EXPECT_EQ(corner_points(read_file(b.glb())), expected);
  }
  Builder strip = square();
  Json& primitive = strip.json["meshes"][0]["primitives"][0];
  primitive["mode"] = 5;
  primitive["indices"] = strip.add("SCALAR", 5123, {1, 2, 0, 3});
  EXPECT_EQ(corner_points(read_file(strip.glb())),
            (std::vector<Vec3>{expected[1], expected[2], expected[0], expected[2], expected[5],
                               expected[0]}));
  Builder fan = square();
  fan.json["meshes"][0]["primitives"][0]["mode"] = 6;
  fan.json["meshes"][0]["primitives"][0].erase("indices");
  EXPECT_EQ(corner_points(read_file(fan.glb())),
            (std::vector<Vec3>{expected[1], expected[2], expected[0], expected[2], expected[5],
                               expected[0]}));
}

TEST(GltfRead, QuantisedPositionsNeedTheirExtension) {
  Builder b;
  const std::size_t position = b.add("VEC3", 5122, {0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0});
  b.json["accessors"][position]["count"] = 3;
  b.json["bufferViews"][0]["byteStride"] = 8;
  b.json["accessors"][position]["normalized"] = true;
  b.add_primitive({{"POSITION", position}});
  EXPECT_EQ(error_of(b.glb()).code(), ErrorCode::malformed_gltf);
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(corner_points(read_file(b.glb())),
            (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}));
}

TEST(GltfRead, SparseElementsReplaceThoseBelow) {
  Builder b = square();
  const std::size_t indices = b.add_view(std::string("\x02\0", 2));
  const float point[3] = {5, 6, 7};
  const std::size_t values = b.add_view(std::string(reinterpret_cast<const char*>(point), 12));
  b.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(read_file(b.glb()).surfaces()[0].mesh.positions[2], Vec3(5, 6, 7));
}

TEST(GltfRead, PointsAndLinesAreLeftAlone) {
  Builder b = square();
  b.add_primitive({{"POSITION", 0}})["mode"] = 0;
  b.add_primitive({{"POSITION", 0}})["mode"] = 3;
  const Asset asset = read_file(b.glb());
  EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 2);
  b.json["meshes"][0]["primitives"].erase(0);
  EXPECT_EQ(error_of(b.glb()).code(), ErrorCode::no_triangles);
}

TEST(GltfRead, WhatIsSharedIsTakenOnce) {
  Builder b = square();
  const Json primitive = b.json["meshes"][0]["primitives"][0];
  for (int i = 0; i < 100'000; ++i) b.json["meshes"][0]["primitives"].push_back(primitive);
  b.json["meshes"].push_back(b.json["meshes"][0]);
  const Asset asset = read_file(b.glb());
  ASSERT_EQ(asset.surfaces().size(), 1U);
  EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 2);
}

TEST(GltfRead, AMeshHoldsOnlyTheVerticesItUses) {
  Builder b = grid(50);
  b.json["meshes"][0]["primitives"][0]["indices"] = b.add("SCALAR", 5123, {2600, 7, 9});
  const Asset asset = read_file(b.glb());
  EXPECT_EQ(asset.surfaces()[0].mesh.vertex_count(), 3);
  EXPECT_EQ(asset.surfaces()[0].mesh.faces[0], (Triangle{2, 0, 1}));
}

TEST(GltfRead, PartsAreNumbersOfPrimitives) {
  Builder b = square();
  b.add_primitive({{"POSITION", 0}}, b.add("SCALAR", 5123, {3, 2, 1}));
  const Asset asset = read_file(b.glb());
  EXPECT_EQ(asset.surfaces()[0].part, (std::vector<Index>{0, 0, 1}));
  EXPECT_EQ(asset.surfaces()[0].name, "/meshes/0");
  EXPECT_EQ(asset.surfaces()[0].mesh.vertex_count(), 4);
}

TEST(GltfRead, LongChainsOfNodesAreFineAndManyInstancesAreOneSurface) {
  Builder b = square();
  b.json["nodes"] = Json::array();
  for (int i = 0; i < 100'000; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
  b.json["nodes"].push_back({{"mesh", 0}});
  for (int i = 0; i < 100'000; ++i) b.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(read_file(b.glb()).surfaces().size(), 1U);
}

TEST(GltfRead, ANodeMayHaveSeveralParentsButNoCycle) {
  Builder b = square();
  b.json["nodes"] = Json::parse(R"([{"children": [2, 2]}, {"children": [2]}, {"mesh": 0}])");
  const Asset asset = read_file(b.glb());
  ASSERT_EQ(asset.repairs().size(), 1U);
  EXPECT_EQ(asset.repairs()[0].kind, FileRepairKind::shared_nodes_kept);
  EXPECT_EQ(asset.repairs()[0].count, 1);
  EXPECT_EQ(json_of(write(asset, split_nowhere(asset), Format::glb))["nodes"], b.json["nodes"]);
  for (const char* nodes :
       {R"([{"children": [0]}])", R"([{"children": [1, 1]}, {"children": [0]}])",
        R"([{"children": [1]}, {"children": [2]}, {"children": [1]}])"}) {
    b.json["nodes"] = Json::parse(nodes);
    EXPECT_EQ(error_of(b.glb()).code(), ErrorCode::malformed_gltf) << nodes;
  }
}

TEST(GltfRead, NoPathOfSharedNodesIsWalkedTwice) {
  Builder b = square();
  b.json["nodes"] = Json::array();
  for (int i = 0; i < 20'000; ++i) b.json["nodes"].push_back({{"children", {i + 1, i + 1}}});
  b.json["nodes"].push_back({{"mesh", 0}});  // 2^20,000 ways lead here
  EXPECT_EQ(read_file(b.glb()).repairs()[0].count, 20'000);
}

struct Fault {
  std::string pointer;
  ErrorCode code;
  std::function<void(Builder&)> make;
};

TEST(GltfRead, EveryFaultIsNamedWithItsPlace) {
  const std::vector<Fault> faults = {
      {"", ErrorCode::malformed_gltf, [](Builder& b) { b.json.erase("asset"); }},
      {"/asset/version", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["asset"]["version"] = "1.0"; }},
      {"/extensionsRequired/0", ErrorCode::unsupported_extension,
       [](Builder& b) { b.json["extensionsRequired"] = {"EVIL_x"}; }},
      {"/accessors/0", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["count"] = 2000000000; }},
      {"/accessors/0/count", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["count"] = -1; }},
      {"/accessors/0/count", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["count"] = 3.5; }},
      {"/accessors/0/byteOffset", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["byteOffset"] = 18446744073709551612ULL; }},
      {"/accessors/0/bufferView", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["bufferView"] = 7; }},
      {"/accessors/0/type", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["type"] = "VEC5"; }},
      {"/accessors/0/componentType", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][0]["componentType"] = 5124; }},
      {"/accessors/1", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["accessors"][1]["componentType"] = 5126; }},
      {"/accessors/0/count", ErrorCode::too_many_vertices,
       [](Builder& b) {
         b.json["accessors"][0].erase("bufferView");
         b.json["accessors"][0]["count"] = 1000000000;
       }},
      {"/bufferViews/0", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["bufferViews"][0]["byteLength"] = 1000; }},
      {"/bufferViews/0/byteStride", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["bufferViews"][0]["byteStride"] = 0xffffffffU; }},
      {"/nodes/0/mesh", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["nodes"][0]["mesh"] = 99; }},
      {"/nodes/0", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["nodes"][0]["children"] = {0}; }},
      {"/meshes/0/primitives/0/material", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["meshes"][0]["primitives"][0]["material"] = 0; }},
      {"/meshes/0/primitives/0/attributes/POSITION", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = "0"; }},
      {"/meshes/0/primitives/0/mode", ErrorCode::malformed_gltf,
       [](Builder& b) { b.json["meshes"][0]["primitives"][0]["mode"] = 7; }},
      {"/meshes/0/primitives/0", ErrorCode::malformed_gltf,
       [](Builder& b) {
         b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
             b.add("VEC3", 5126, {0, 0, 1});
       }},
      {"/meshes", ErrorCode::malformed_gltf, [](Builder& b) { b.json["meshes"] = "a"; }},
  };
  for (const Fault& fault : faults) {
    Builder b = square();
    fault.make(b);
    const Error error = error_of(b.glb());
    EXPECT_EQ(error.code(), fault.code) << fault.pointer << ": " << error.what();
    EXPECT_EQ(error.where(), fault.pointer) << error.what();
  }
}

TEST(GltfRead, AnAccessorMayEndWithItsViewButNotAByteLater) {
  struct Layout {
    std::size_t offset, count, stride;
    bool fits;
  };
  const std::vector<Layout> layouts = {{0, 4, 0, true},    {0, 5, 0, false},    {12, 3, 0, true},
                                       {12, 4, 0, false},  {13, 3, 0, false},   {0, 3, 16, true},
                                       {4, 3, 16, true},   {8, 3, 16, false},   {0, 4, 16, false},
                                       {36, 1, 252, true}, {37, 1, 252, false}, {0, 3, 8, false}};
  for (const Layout& layout : layouts) {
    Builder b = square();
    b.json["accessors"][0]["byteOffset"] = layout.offset;
    b.json["accessors"][0]["count"] = layout.count;
    if (layout.stride > 0) b.json["bufferViews"][0]["byteStride"] = layout.stride;
    b.json["meshes"][0]["primitives"][0]["indices"] = b.add("SCALAR", 5121, {0, 0, 0});
    const std::string file = b.glb();
    SCOPED_TRACE(b.json["accessors"][0].dump() + std::to_string(layout.stride));
    if (layout.fits)
      EXPECT_NO_THROW(read_file(file));
    else
      EXPECT_EQ(error_of(file).where(), "/accessors/0");
  }
}

TEST(GltfRead, NoIndexMayPassTheVerticesOrRestart) {
  for (const double index : {4.0, 65535.0}) {
    Builder b = square();
    b.json["meshes"][0]["primitives"][0]["indices"] = b.add("SCALAR", 5123, {0, 1, index});
    EXPECT_EQ(error_of(b.glb()).where(), "/accessors/2");
  }
}

TEST(GltfRead, PositionsAreFinite) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    Builder b = square();
    b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
        b.add("VEC3", 5126, {0, 0, 0, 1, bad, 0, 1, 1, 0, 0, 1, 0});
    EXPECT_EQ(error_of(b.glb()).code(), ErrorCode::non_finite_position);
  }
}

TEST(GltfRead, LimitsHoldBeforeAnythingIsDecoded) {
  const std::string file = grid(10).glb();
  EXPECT_EQ(error_of(file, {.max_vertices = 120}).code(), ErrorCode::too_many_vertices);
  EXPECT_EQ(error_of(file, {.max_faces = 199}).code(), ErrorCode::too_many_faces);
  EXPECT_EQ(read({file, {}}, {.max_vertices = 121, .max_faces = 200}).surfaces().size(), 1U);
}

}  // namespace
}  // namespace unwrapd::asset::test
