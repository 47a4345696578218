// Colours of vertices, from every format that has them to every format of answers. The formula of
// sRGB is written out here once more.
#include <gmock/gmock.h>

#include <cmath>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/asset/mesh_file_samples.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::HasSubstr;
using Colours = std::vector<std::vector<double>>;

/// What a screen shows of a stored value.
double light(double stored) {
  return stored > 0.04045 ? std::pow((stored + 0.055) / 1.055, 2.4) : stored / 12.92;
}

/// The sRGB of the corners in the order of the faces, with alpha.
Colours colours_in_gltf(const std::string& answer) {
  Colours corners;
  for (const ReadPrimitive& primitive : read_naively(answer))
    for (const auto& face : primitive.faces) {
      if (!face.contains("COLOR_0")) continue;
      for (const std::vector<double>& colour : face.at("COLOR_0")) corners.push_back(colour);
    }
  return corners;
}

Colours colours_in_obj(const std::string& answer) {
  Colours colours;
  std::istringstream lines(answer);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("v ")) continue;
    std::istringstream words(line.substr(2));
    const std::vector<double> all(std::istream_iterator<double>(words), {});
    if (all.size() > 3) colours.emplace_back(all.begin() + 3, all.end());
  }
  return colours;
}

void expect_light(const Colours& found, const Colours& stored) {
  ASSERT_EQ(found.size(), stored.size());
  for (std::size_t v = 0; v < stored.size(); ++v)
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(found[v][k], k < 3 ? light(stored[v][k]) : stored[v][k], 1e-5)
          << "corner " << v << ", channel " << k;
}

void expect_near(const Colours& found, const Colours& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t v = 0; v < wanted.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[v][k], wanted[v][k], 1e-4);
}

std::string answer_of(const std::string& file, Format output) {
  const Asset asset = read_file(file);
  return write(asset, split_nowhere(asset), output);
}

std::string dropped_of(const std::string& file, Format output) {
  const Asset asset = read_file(file);
  for (const Note& note : side_effects(asset, split_nowhere(asset), output))
    if (note.code == NoteCode::data_dropped) return note.text;
  return "";
}

/// Three vertices and their triangle. properties: after the positions.
std::string ply(const std::vector<std::string>& properties, const std::vector<std::string>& rows) {
  std::string file =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\n";
  for (const std::string& property : properties) file += "property " + property + "\n";
  file += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::vector<std::string> corners = {"0 0 0 ", "1 0 0 ", "0 1 0 "};
  for (std::size_t v = 0; v < 3; ++v) file += corners[v] + rows[v] + "\n";
  return file + "3 0 1 2\n";
}

const Colours kThree = {{1, 0, 0, 1}, {0.2, 0.4, 0.6, 1}, {0, 1, 0.8, 1}};

TEST(Colours, OfAPlyAreKeptWhateverTheirType) {
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> files = {
      {{"uchar red", "uchar green", "uchar blue"}, {"255 0 0", "51 102 153", "0 255 204"}},
      {{"ushort red", "ushort green", "ushort blue"},
       {"65535 0 0", "13107 26214 39321", "0 65535 52428"}},
      {{"float diffuse_red", "float diffuse_green", "float diffuse_blue"},
       {"1 0 0", "0.2 0.4 0.6", "0 1 0.8"}},
      {{"float red", "float green", "float blue"}, {"255 0 0", "51 102 153", "0 255 204"}}};
  for (const auto& [properties, rows] : files) {
    SCOPED_TRACE(properties[0]);
    const std::string file = ply(properties, rows);
    for (const Format output : {Format::glb, Format::gltf})
      expect_light(colours_in_gltf(answer_of(file, output)), kThree);
    expect_near(colours_in_obj(answer_of(file, Format::obj)), kThree);
    EXPECT_EQ(dropped_of(file, Format::glb), "");
  }
}

TEST(Colours, AlmostInRangeAreNoBytes) {
  const std::vector<std::string> floats = {"float red", "float green", "float blue"};
  for (const std::string red : {"1.0000001", "1.02", "inf"}) {
    const std::string file = ply(floats, {red + " 0 0", "0.2 0.4 0.6", "0 1 0.8"});
    expect_light(colours_in_gltf(answer_of(file, Format::glb)), kThree);
  }
}

TEST(Colours, OfIntegersHaveTheUnitOfTheirType) {
  const std::string ints = ply({"int red", "int green", "int blue"}, {"1 0 1", "0 0 0", "0 1 0"});
  expect_light(colours_in_gltf(answer_of(ints, Format::glb)),
               {{1. / 255, 0, 1. / 255, 1}, {0, 0, 0, 1}, {0, 1. / 255, 0, 1}});
  Colours clear = kThree;
  clear[0][3] = 0.2, clear[2][3] = 0;
  for (const std::string type : {"uchar", "int", "float"}) {
    const std::string file = ply({type + " red", "uchar green", type + " blue", "uchar alpha"},
                                 {"255 0 0 51", "51 102 153 255", "0 255 204 0"});
    expect_light(colours_in_gltf(answer_of(file, Format::glb)), clear);
  }
  const std::string floats = ply({"float red", "float green", "float blue", "float alpha"},
                                 {"255 0 0 0.2", "51 102 153 1", "0 255 204 0"});
  expect_light(colours_in_gltf(answer_of(floats, Format::glb)), clear);
}

TEST(Colours, AreBytesWhereTheirAlphaIs) {
  const std::string file =
      "COFF\n3 1 0\n0 0 0 1 0 1 255\n1 0 0 0 0 0 255\n0 1 0 0 1 0 255\n3 0 1 2\n";
  expect_light(colours_in_gltf(answer_of(file, Format::glb)),
               {{1. / 255, 0, 1. / 255, 1}, {0, 0, 0, 1}, {0, 1. / 255, 0, 1}});
}

TEST(Colours, OfAnObjLackTheAlphaAndSaySo) {
  const std::vector<std::string> properties = {"uchar red", "uchar green", "uchar blue",
                                               "uchar alpha"};
  const std::string clear = ply(properties, {"1 2 3 7", "1 2 3 255", "1 2 3 255"});
  const std::string dense = ply(properties, {"1 2 3 255", "1 2 3 255", "1 2 3 255"});
  EXPECT_THAT(dropped_of(clear, Format::obj), HasSubstr(": vertex alpha."));
  EXPECT_EQ(dropped_of(clear, Format::glb), "");
  EXPECT_EQ(dropped_of(dense, Format::obj), "");
  const std::string clear_glb = answer_of(clear, Format::glb);
  EXPECT_THAT(dropped_of(clear_glb, Format::obj), HasSubstr("the alpha of colours"));
  EXPECT_EQ(dropped_of(answer_of(dense, Format::glb), Format::obj).find("colours"),
            std::string::npos);
}

TEST(Colours, OfTwoMeshesOfTheSameGeometryAreTold) {
  Builder b = square();
  b.json["meshes"].push_back(b.json["meshes"][0]);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t colours =
        b.add("VEC3", 5126, std::vector<double>(12, static_cast<double>(k)));
    b.json["meshes"][k]["primitives"][0]["attributes"]["COLOR_0"] = colours;
  }
  EXPECT_THAT(dropped_of(b.glb(), Format::obj), HasSubstr("other colours of vertices"));
  b.json["meshes"][1]["primitives"][0]["attributes"].erase("COLOR_0");
  EXPECT_THAT(dropped_of(b.glb(), Format::obj), HasSubstr("other colours of vertices"));
}

TEST(Colours, OfAVertexThatTwoPrimitivesColourAreTold) {
  Builder b = square();
  Json& primitives = b.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const std::vector<double> corners = {0, 2, 3};
  for (std::size_t k = 0; k < 2; ++k) {
    primitives[k]["attributes"]["COLOR_0"] =
        b.add("VEC3", 5126, std::vector<double>(12, static_cast<double>(k)));
    primitives[k]["indices"] =
        b.add("SCALAR", 5123, k == 0 ? std::vector<double>{0, 1, 2} : corners);
  }
  EXPECT_THAT(dropped_of(b.glb(), Format::obj), HasSubstr("other colours of vertices"));
}

TEST(Colours, ThatLackAChannelAreToldAsLeftOut) {
  const std::string file =
      ply({"uchar red", "uchar blue", "uchar alpha"}, {"1 2 3", "1 2 3", "1 2 3"});
  EXPECT_THAT(dropped_of(file, Format::glb), HasSubstr(": vertex red, vertex blue, vertex alpha."));
  EXPECT_TRUE(colours_in_gltf(answer_of(file, Format::glb)).empty());
  EXPECT_THAT(dropped_of(ply({"float nx", "float s"}, {"1 2", "1 2", "1 2"}), Format::glb),
              HasSubstr(": vertex nx, vertex s."));
}

TEST(Colours, OfBytesComeBackThroughGltfAsTheSameBytes) {
  for (int value = 0; value < 256; value += 3) {
    const std::string grey = std::to_string(value) + " " + std::to_string(value) + " 255";
    const std::string glb =
        answer_of(ply({"uchar red", "uchar green", "uchar blue"}, {grey, grey, grey}), Format::glb);
    const Colours back = colours_in_obj(answer_of(glb, Format::obj));
    ASSERT_EQ(back.size(), 3U);
    for (const std::vector<double>& colour : back) {
      EXPECT_EQ(std::lround(255 * colour[0]), value);
      EXPECT_EQ(std::lround(255 * colour[2]), 255);
    }
  }
}

TEST(Colours, OfAnObjAreKept) {
  const std::string face = "f 1 2 3\n";
  const std::string shares = "v 0 0 0 1 0 0\nv 1 0 0 .2 .4 .6\nv 0 1 0 0 1 .8\n" + face;
  const std::string bytes = "v 0 0 0 255 0 0\nv 1 0 0 51 102 153\nv 0 1 0 0 255 204\n" + face;
  for (const std::string& file : {shares, bytes}) {
    expect_light(colours_in_gltf(answer_of(file, Format::glb)), kThree);
    EXPECT_EQ(dropped_of(file, Format::glb), "");
  }
  EXPECT_THAT(answer_of(shares, Format::obj), HasSubstr("v 1 0 0 .2 .4 .6\n"));
  const std::string some = "v 0 0 0\nv 1 0 0 51 102 153\nv 0 1 0 nan inf -4\n" + face;
  expect_light(colours_in_gltf(answer_of(some, Format::glb)),
               {{1, 1, 1, 1}, {0.2, 0.4, 0.6, 1}, {1, 1, 0, 1}});
  EXPECT_TRUE(
      colours_in_gltf(answer_of("v 0 0 0 1\nv 1 0 0\nv 0 1 0\n" + face, Format::glb)).empty());
}

TEST(Colours, OfAnOffAreKept) {
  const std::string shares = "3 1 0\n0 0 0 1 0 0 1\n1 0 0 .2 .4 .6 1\n0 1 0 0 1 .8 1\n3 0 1 2\n";
  const std::string bytes =
      "3 1 0\n0 0 0 255 0 0 255\n1 0 0 51 102 153 255 # blue\n0 1 0 0 255 204 255\n3 0 1 2\n";
  for (const std::string keyword : {"OFF\n", "COFF\n"})
    for (const std::string& rest : {shares, bytes}) {
      expect_light(colours_in_gltf(answer_of(keyword + rest, Format::glb)), kThree);
      expect_near(colours_in_obj(answer_of(keyword + rest, Format::obj)), kThree);
    }
}

TEST(Colours, OfAGltfAreKeptByAnObj) {
  const std::vector<double> bytes = {255, 0, 0, 255, 33, 67, 101, 0, 0, 255, 154, 9, 4, 5, 6, 7};
  Builder b = square();
  b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = b.add("VEC4", 5121, bytes);
  b.json["accessors"].back()["normalized"] = true;
  const Colours found = colours_in_obj(answer_of(b.glb(), Format::obj));
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t v = 0; v < 4; ++v)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(light(found[v][k]), bytes[4 * v + k] / 255, 1e-6);
  EXPECT_THAT(dropped_of(b.glb(), Format::obj), HasSubstr("glTF: the alpha of colours."));
}

TEST(Colours, OfOnePrimitiveLeaveTheOthersWhite) {
  Builder b = square();
  Json plain = b.json["meshes"][0]["primitives"][0];
  plain["attributes"]["POSITION"] = b.add("VEC3", 5126, {5, 0, 0, 6, 0, 0, 6, 1, 0, 5, 1, 0});
  b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      b.add("VEC3", 5126, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, std::nan("")});
  b.json["meshes"][0]["primitives"].push_back(plain);
  Colours wanted(4, {0, 0, 0});
  wanted.resize(8, {1, 1, 1});
  EXPECT_EQ(colours_in_obj(answer_of(b.glb(), Format::obj)), wanted);
}

}  // namespace
}  // namespace unwrapd::asset::test
