// The preview of a scene is that of the same meshes where nodes put them.
#include "server/work/rendering.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "api/options.hpp"
#include "server/work/uv_file.hpp"

namespace unwrapd::server::work {
namespace {

/// The preview of two triangles, each a mesh, the second of them `x` to the right, and both under
/// the members of their nodes.
std::string preview_of(float x, const std::string& first, const std::string& second) {
  const std::array<float, 18> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0, x, 0, 0, x + 1, 0, 0, x, 1, 0};
  std::string bytes(sizeof corners, '\0');
  std::memcpy(bytes.data(), corners.data(), bytes.size());
  const std::string document = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0)" + first +
                               R"(}, {"mesh": 1)" + second + R"(}],
    "bufferViews": [{"buffer": 0, "byteLength": 72}], "buffers": [{"byteLength": 72, "uri": "b"}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]},
      {"primitives": [{"attributes": {"POSITION": 1}}]}]})";
  const UnwrappedSurface half{
      .faces = {{0, 1, 2}}, .source = {0, 1, 2}, .uv = {{0, 0}, {0.4, 0}, {0, 0.4}}};
  const std::string uvs = encode_uvs({half, half});
  store::JobRecord record;
  record.options = api::to_json(api::preset_options({}));
  return render(
      {.map = 0, .picture = Picture{.kind = PictureKind::preview_png, .size = 128}, .format = {}},
      {.record = record, .asset = {document, {{"b", bytes}}}, .uvs = uvs, .report = {}}, {});
}

TEST(Preview, ShowsMeshesWhereNodesPutThem) {
  const std::string apart = preview_of(3, "", "");
  EXPECT_EQ(preview_of(0, "", R"(, "translation": [3, 0, 0])"), apart);
  EXPECT_EQ(preview_of(4, R"(, "scale": [1, 1, 1])", R"(, "translation": [-1, 0, 0])"), apart);
  EXPECT_NE(preview_of(0, "", ""), apart);
}

TEST(Preview, ShowsNoMeshThatTheSceneDoesNotShow) {
  EXPECT_EQ(preview_of(3, "", R"(, "scale": [0, 0, 0])"),
            preview_of(0, "", R"(, "scale": [0, 0, 0])"));
}

}  // namespace
}  // namespace unwrapd::server::work
