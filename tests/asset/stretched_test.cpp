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

TEST(Stretched, TheNodeThatShowsAMeshLargestCounts) {
  Builder b = flat();
  b.json["nodes"] =
      Json::parse(R"([{"mesh": 0, "scale": [2, 1, 1]}, {"mesh": 0, "scale": [9, 9, 9]}])");
  b.json["scenes"] = Json::parse(R"([{"nodes": [0, 1]}])");
  EXPECT_EQ(note_on(b), "");
  b.json["nodes"][1]["scale"] = {1, 1, 1};
  EXPECT_THAT(note_on(b), HasSubstr("(2 to 1)"));
  EXPECT_THAT(note_on(b, Format::obj), HasSubstr("(2 to 1)"));
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
