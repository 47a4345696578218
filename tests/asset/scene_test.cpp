// How large and where a scene shows its meshes, read from nodes, matrices and skins.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/asset/support.hpp"

namespace unwrapd::asset {
namespace {

using namespace test;

/// Two meshes of different geometry in the plane z = 0, shown by these nodes.
Builder two_meshes(const std::string& nodes) {
  Builder b;
  b.json["meshes"] = Json::array();
  for (const double side : {1, 3}) {
    const std::size_t corners = b.add("VEC3", 5126, {0, 0, 0, side, 0, 0, 0, side, 0});
    b.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", corners}}}}}}});
  }
  b.json["nodes"] = Json::parse(nodes);
  b.json.erase("scenes"), b.json.erase("scene");
  return b;
}

std::vector<double> scales_of(const Builder& b) {
  const Asset asset = read_file(b.glb());
  std::vector<double> scales;
  for (const Surface& surface : asset.surfaces()) scales.push_back(surface.scale);
  return scales;
}

void expect_scales(const std::string& nodes, double first, double second) {
  const std::vector<double> scales = scales_of(two_meshes(nodes));
  ASSERT_EQ(scales.size(), 2U);
  EXPECT_NEAR(scales[0], first, 1e-9 * first) << nodes;
  EXPECT_NEAR(scales[1], second, 1e-9 * second) << nodes;
}

TEST(Scales, MultiplyAlongTheParents) {
  expect_scales(R"([{"mesh": 0, "scale": [2, 2, 2], "children": [1]},
                    {"scale": [0.5, 0.5, 0.5], "rotation": [0, 0.6, 0, 0.8], "children": [2]},
                    {"mesh": 1, "scale": [7, 7, 7], "translation": [5, 5, 5]}])",
                2, 7);
}

TEST(Scales, AreThoseOfMatrices) {
  expect_scales(R"([{"mesh": 0, "matrix": [0, 3, 0, 0, -3, 0, 0, 0, 0, 0, 3, 0, 9, 9, 9, 1]},
                    {"mesh": 1, "matrix": [-4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1]}])",
                3, 4);
}

TEST(Scales, AreThoseOfTheArea) {
  expect_scales(R"([{"mesh": 0, "scale": [8, 8, 1]}, {"mesh": 1, "scale": [2, 8, 500]}])", 8, 4);
  expect_scales(R"([{"mesh": 0, "scale": [8, 8, 0]}, {"mesh": 1, "rotation": [0, 0, 0, 5]}])", 8,
                1);
}

TEST(Scales, AreThoseOfTheLargestShown) {
  expect_scales(R"([{"mesh": 0, "scale": [2, 2, 2]}, {"mesh": 1}, {"mesh": 0},
                    {"mesh": 1, "scale": [0.1, 0.1, 0.1]}])",
                2, 1);
}

TEST(Scales, OfWhatNoNodeShowsAreTheLeastOfTheOthers) {
  expect_scales(R"([{"mesh": 1, "scale": [0.01, 0.01, 0.01]}])", 0.01, 0.01);
  expect_scales(R"([{"mesh": 0, "scale": [0, 0, 0]}, {"mesh": 1, "scale": [0.01, 0.01, 0.01]}])",
                0.01, 0.01);
  expect_scales("[{}]", 1, 1);
}

TEST(Scales, CountWithoutRoundingWhereNodesOnlyTurn) {
  const std::vector<double> scales = scales_of(
      two_meshes(R"([{"mesh": 0, "rotation": [0.1825742, 0.3651484, 0.5477226, 0.7302967]},
                               {"mesh": 1, "scale": [1.0000001, 0.9999999, 1]}])"));
  EXPECT_EQ(scales[0], 1);
  EXPECT_EQ(scales[1], 1);
}

TEST(Scales, AreOneWhereMembersAreWrong) {
  for (const char* node :
       {R"({"mesh": 0, "scale": [2, 2]})", R"({"mesh": 0, "scale": "2"})",
        R"({"mesh": 0, "scale": [2, 2, null]})", R"({"mesh": 0, "matrix": [1, 2]})",
        R"({"mesh": 0, "rotation": [0, 0, 0, 0]})",
        R"({"mesh": 0, "scale": [1e300, 1e300, 1e300]})", R"({"mesh": 0, "skin": 3})",
        R"({"mesh": 0, "skin": "0"})"})
    expect_scales("[" + std::string(node) + R"(, {"mesh": 1}])", 1, 1);
}

TEST(Scales, OfSkinnedMeshesAreThoseOfTheirJoints) {
  Builder b = two_meshes(R"([{"mesh": 0, "skin": 0, "scale": [50, 50, 50]}, {"mesh": 1},
                             {"scale": [0.5, 0.5, 0.5], "children": [3]}, {"name": "joint"}])");
  b.json["skins"] = {{{"joints", {3, 2}}}};
  EXPECT_EQ(scales_of(b)[0], 0.5);
  b.json["skins"][0]["inverseBindMatrices"] =
      b.add("MAT4", 5126, {6, 0, 0, 0, 0, 6, 0, 0, 0, 0, 6, 0, 1, 2, 3, 1});
  EXPECT_EQ(scales_of(b)[0], 3);
}

TEST(Scales, ReachMeshesOfTheSameGeometry) {
  Builder b = square();
  b.json["meshes"].push_back(b.json["meshes"][0]);
  b.json["nodes"] =
      Json::parse(R"([{"mesh": 0, "children": [1]}, {"mesh": 1, "scale": [3, 3, 3]}])");
  EXPECT_EQ(scales_of(b), std::vector<double>{3});
}

TEST(Scales, CountInTheDefaultSceneOnlyUnlessItShowsNothing) {
  Builder b = two_meshes(R"([{"mesh": 0}, {"mesh": 1}, {"mesh": 1, "scale": [9, 9, 9]}, {}])");
  b.json["scenes"] = Json::parse(R"([{"nodes": [3]}, {"nodes": [0, 1]}, {"nodes": [2]}])");
  b.json["scene"] = 1;
  EXPECT_EQ(scales_of(b), (std::vector<double>{1, 1}));
  b.json["scene"] = 2;
  EXPECT_EQ(scales_of(b), (std::vector<double>{9, 9}));
  b.json.erase("scene");
  EXPECT_EQ(scales_of(b), (std::vector<double>{1, 9}));
}

/// The surfaces in the order in which the scene shows them, and where their origins are along x.
std::vector<std::pair<std::size_t, double>> shown_in(const Builder& b) {
  const Asset asset = read_file(b.glb());
  std::vector<std::pair<std::size_t, double>> shown;
  for (const auto& [surface, placement] : shown_surfaces(asset))
    shown.emplace_back(surface, placement.origin.x());
  return shown;
}

using Shown = std::vector<std::pair<std::size_t, double>>;

TEST(ShownSurfaces, AreThoseOfTheNodes) {
  EXPECT_EQ(shown_in(two_meshes(R"([{"mesh": 1, "translation": [5, 0, 0], "children": [1]},
                                    {"mesh": 0, "translation": [2, 0, 0]}, {"mesh": 1}])")),
            (Shown{{1, 5}, {0, 7}, {1, 0}}));
  EXPECT_EQ(shown_in(two_meshes(R"([{"mesh": 0}])")), (Shown{{0, 0}}));
}

TEST(ShownSurfaces, AreNotThoseOfNodesThatHideThem) {
  for (const char* hidden :
       {R"("scale": [0, 0, 0])", R"("scale": [1e-13, 1e-13, 1e-13])", R"("scale": [1e300, 1, 1])",
        R"("translation": [1e31, 0, 0])", R"("translation": [1e308, 0, 0], "scale": [9, 9, 9])"}) {
    const std::string node = std::string(R"({"mesh": 0, )") + hidden + "}";
    EXPECT_EQ(shown_in(two_meshes("[" + node + R"(, {"mesh": 1, "translation": [2, 0, 0]}])")),
              (Shown{{1, 2}}))
        << hidden;
    const Asset asset = read_file(two_meshes("[" + node + "]").glb());
    EXPECT_EQ(
        read_file(write(asset, split_nowhere(asset), Format::obj)).surfaces()[0].mesh.positions[1],
        Vec3(1, 0, 0))
        << hidden;
  }
}

TEST(ShownSurfaces, AreNoneWhereTheyLieAsTheyAre) {
  EXPECT_EQ(shown_in(two_meshes(R"([{"mesh": 0}, {"mesh": 1}])")), Shown{});
  EXPECT_EQ(shown_in(two_meshes("[]")), Shown{});
  EXPECT_TRUE(shown_surfaces(read_file("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).empty());
}

TEST(ShownSurfaces, AreShownOnceEachWhereNodesAreTooMany) {
  Builder b = two_meshes("[]");
  for (std::size_t i = 0; i <= kMostShownFaces; ++i)
    b.json["nodes"].push_back({{"mesh", i % 2}, {"translation", {i, 0, 0}}});
  EXPECT_EQ(shown_in(b), (Shown{{0, 0}, {1, 1}}));
  b.json["nodes"].erase(0);
  EXPECT_EQ(shown_in(b).size(), kMostShownFaces);
}

}  // namespace
}  // namespace unwrapd::asset
