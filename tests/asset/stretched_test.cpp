// Nodes that show a mesh longer in one direction than in another, and the note on them.
#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::HasSubstr;

std::string note_on(const Builder& b, Format output = Format::glb) {
  const Asset asset = read_file(b.glb());
  for (const Note& note : side_effects(asset, split_nowhere(asset), output))
    if (note.code == NoteCode::nodes_stretch) return note.text;
  return "";
}

/// A rectangle in the plane z = 0.
std::size_t add_rectangle(Builder& b, double width) {
  return b.add("VEC3", 5126, {0, 0, 0, width, 0, 0, width, 1, 0, 0, 1, 0});
}

Builder flat() {
  Builder b = square();
  const std::size_t positions = add_rectangle(b, 1);
  b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = positions;
  return b;
}

std::string note_at(const Json& node) {
  Builder b = flat();
  b.json["nodes"][0].update(node);
  return note_on(b);
}

TEST(Stretched, MeshesAreNamedWithTheirRatio) {
  const std::string note = note_at({{"scale", {6, 3, 1}}});
  EXPECT_THAT(note, HasSubstr("/meshes/0"));
  EXPECT_THAT(note, HasSubstr("(2 to 1)"));
  EXPECT_THAT(note_at({{"scale", {1, -2.5, 7}}}), HasSubstr("(2.5 to 1)"));
  const double half = 0.7071067811865476;  // a quarter turn, then twice as long
  EXPECT_THAT(note_at({{"matrix", {0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}),
              HasSubstr("(2 to 1)"));
  EXPECT_THAT(note_at({{"matrix", {1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}),
              HasSubstr("(2.62 to 1)"));  // a shear: the square of the golden ratio
  EXPECT_EQ(note_at({{"rotation", {0, 0, half, half}}, {"scale", {4, 4, 4}}}), "");
}

TEST(Stretched, WhatNobodySeesIsNoReason) {
  for (const Json& scale : {Json{1, 1, 20}, Json{1.1, 1, 1}, Json{-3, 3, 3}, Json{0, 1, 1}})
    EXPECT_EQ(note_at({{"scale", scale}}), "") << scale;
}

/// A box, and a triangle of this height beside it.
Builder box_and_sliver(double height) {
  Builder b = square();
  std::vector<double> points;
  for (int k = 0; k < 8; ++k)
    for (int axis = 0; axis < 3; ++axis) points.push_back(k >> axis & 1);
  for (const double x : {0., 0., 2., 1., height, 2., .4, 0., 2.}) points.push_back(x);
  const std::vector<double> corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6,
                                       3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5, 8, 9, 10};
  const std::size_t positions = b.add("VEC3", 5126, points),
                    indices = b.add("SCALAR", 5123, corners);
  b.json["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", positions}}},
                                          {"indices", indices}};
  return b;
}

TEST(Stretched, ABoxHasTheRatioOfItsLongFaces) {
  Builder b = box_and_sliver(6e-17);
  b.json["nodes"][0]["scale"] = {3.5, 1, 1};
  EXPECT_THAT(note_on(b), HasSubstr("(3.5 to 1)"));
}

TEST(Stretched, EdgesOfAThinPlateAreNoReason) {
  Builder b = box_and_sliver(6e-17);
  b.json["nodes"][0]["scale"] = {10, 10, 0.01};
  EXPECT_EQ(note_on(b), "");
}

TEST(Stretched, TurnsAreNoReasonWhateverTheFaces) {
  for (const double height : {6e-17, 1e-25, 1e-9}) {
    Builder b = box_and_sliver(height);
    b.json["nodes"][0]["rotation"] = {0.18, 0.36, 0.54, 0.74};
    EXPECT_EQ(note_on(b), "") << height;
    b.json["nodes"][0]["scale"] = {1, 1, 1.0001};
    EXPECT_EQ(note_on(b), "") << height;
  }
}

TEST(Stretched, TheNodeThatShowsAMeshLargestCounts) {
  Builder b = flat();
  const auto set = [&](const Json& first, const Json& second) {
    b.json["nodes"] = {{{"mesh", 0}, {"scale", first}}, {{"mesh", 0}, {"scale", second}}};
    b.json["scenes"] = Json::parse(R"([{"nodes": [0, 1]}])");
  };
  set({2, 1, 1}, {9, 9, 9});
  EXPECT_EQ(note_on(b), "");
  set({1, 3, 1000}, {20, 20, 20});  // of a flat mesh, thickness is nothing
  EXPECT_EQ(note_on(b), "");
  EXPECT_DOUBLE_EQ(read_file(b.glb()).surfaces()[0].scale, 20);
  set({2, 1, 1}, {1, 1, 1});
  for (const Format output : {Format::glb, Format::obj})
    EXPECT_THAT(note_on(b, output), HasSubstr("(2 to 1)"));
}

TEST(Stretched, FewOfManyAreNamed) {
  Builder b = square();
  Json& nodes = b.json["nodes"] = Json::array();
  Json& shown = b.json["scenes"][0]["nodes"] = Json::array();
  const Json mesh = b.json["meshes"][0];
  for (int k = 0; k < 8; ++k) {
    b.json["meshes"][k] = mesh;  // of its own geometry
    const std::size_t positions = add_rectangle(b, 1 + k);
    b.json["meshes"][k]["primitives"][0]["attributes"]["POSITION"] = positions;
    nodes.push_back({{"mesh", k}, {"scale", {1, k == 3 ? 1 : 3, 1}}});
    shown.push_back(k);
  }
  const std::string note = note_on(b);
  EXPECT_THAT(note, HasSubstr("/meshes/5"));
  EXPECT_THAT(note, HasSubstr(" and 2 more."));
  EXPECT_EQ(note.find("/meshes/3"), std::string::npos);
}

}  // namespace
}  // namespace unwrapd::asset::test
