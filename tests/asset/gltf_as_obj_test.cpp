// A glTF as an OBJ: what is where, and what is said to be lacking.
#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include <sstream>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

/// The points and the normals of an OBJ's corners, in the order of its faces.
std::vector<std::array<Vec3, 2>> corners_of_obj(const std::string& obj) {
  std::vector<Vec3> points, normals;
  std::vector<std::array<Vec3, 2>> corners;
  std::istringstream in(obj);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind, corner;
    Vec3 v = Vec3::Zero();
    words >> kind;
    if (kind == "v" || kind == "vn") {
      words >> v.x() >> v.y() >> v.z();
      (kind == "v" ? points : normals).push_back(v);
    }
    while (kind == "f" && words >> corner) {
      const std::size_t normal = std::stoul(corner.substr(corner.rfind('/') + 1));
      corners.push_back({points.at(std::stoul(corner) - 1), normals.at(normal - 1)});
    }
  }
  return corners;
}

TEST(GltfAsObj, MeshesLieWhereNodesPutThemAndNormalsPointOutward) {
  for (const char* node :
       {R"({"mesh": 0, "translation": [1, 2, 3]})", R"({"mesh": 0, "scale": [-2, 1, 1]})",
        R"({"mesh": 0, "scale": [2, 3, -4], "rotation": [0.6, 0, 0, 0.8]})",
        R"({"mesh": 0, "matrix": [0, 0, -1, 0, 0, 3, 0, 0, 1, 0, 0, 0, 4, 4, 4, 1]})"}) {
    Builder b;  // a triangle with its normal, aslant
    b.json["nodes"] = {Json::parse(node)};
    const Vec3 normal = Vec3(1, 1, 1).normalized();
    b.add_primitive({{"POSITION", b.add("VEC3", 5126, {1, 0, 0, 0, 1, 0, 0, 0, 1})},
                     {"NORMAL", b.add("VEC3", 5126, [&] {
                        std::vector<double> all;
                        for (int k = 0; k < 9; ++k) all.push_back(normal[k % 3]);
                        return all;
                      }())}});
    const Asset asset = read_file(b.glb());
    const auto corners = corners_of_obj(write(asset, split_nowhere(asset), Format::obj));
    ASSERT_EQ(corners.size(), 3U) << node;
    const Vec3 &p = corners[0][0], &q = corners[1][0], &r = corners[2][0];
    const Vec3 outward = (q - p).cross(r - p).normalized();
    for (const auto& [point, given] : corners) EXPECT_LT((given - outward).norm(), 1e-6) << node;
    EXPECT_EQ(shown_surfaces(asset).front().placement(Vec3(1, 0, 0)), p) << node;
  }
}

TEST(GltfAsObj, SaysWhatIsLacking) {
  const auto notes_on = [](const Builder& b) {
    const Asset asset = read_file(b.glb());
    std::vector<std::string> texts;
    for (const Note& note : side_effects(asset, split_nowhere(asset), Format::obj)) {
      EXPECT_EQ(note.code, NoteCode::data_dropped);
      texts.push_back(note.text);
    }
    return texts;
  };
  EXPECT_THAT(notes_on(square()), testing::IsEmpty());
  Builder all = square();
  Json& primitive = all.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  for (const char* name : {"COLOR_0", "COLOR_1", "_ID", "TEXCOORD_0", "TEXCOORD_3"})
    primitive["attributes"][name] = name[0] == 'T'
                                        ? all.add("VEC2", 5126, std::vector<double>(8, 0))
                                        : all.add("VEC4", 5126, std::vector<double>(16, 1));
  primitive["targets"] = {{{"POSITION", all.add("VEC3", 5126, std::vector<double>(12, 1))}}};
  all.json["materials"] = {Json::object()};
  all.json["skins"] = {{{"joints", {0}}}};
  all.json["animations"] = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
  const std::vector<std::string> texts = notes_on(all);
  ASSERT_EQ(texts.size(), 1U);
  for (const char* part : {"materials", "other colours of vertices", "other sets",
                           "custom attributes", "morph targets", "skins", "animations"})
    EXPECT_THAT(texts[0], testing::HasSubstr(part));
  Builder twice = square();
  twice.json["nodes"] = Json::parse(R"([{"mesh": 0, "children": [1]}, {"mesh": 0}])");
  EXPECT_THAT(notes_on(twice), testing::ElementsAre(testing::HasSubstr("again: 1.")));
  twice.json["meshes"].push_back(twice.json["meshes"][0]);  // the same geometry
  twice.json["nodes"][1]["mesh"] = 1;
  EXPECT_THAT(notes_on(twice), testing::ElementsAre(testing::HasSubstr("again: 1.")));
}

}  // namespace
}  // namespace unwrapd::asset::test
