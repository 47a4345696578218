// textures=transfer through the server: a real asset looks as before, and what cannot be resampled
// is refused by name.
#include "tests/pipeline/textured_scene.hpp"
#include "tests/samples/test_data.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server {
namespace {

constexpr double kMostDifference = 2;  // of 255
constexpr int kSize = 160;             // pixels

class TransferredTextures : public RunningServer {
 protected:
  httplib::Result unwrap(const std::string& glb, const std::string& query) {
    return client().Post("/v1/unwrap?compression=none&" + query, glb, "model/gltf-binary");
  }
};

TEST_F(TransferredTextures, LookTheSameFromEightSides) {
  const auto data = asset::test::test_data();
  if (!data) GTEST_SKIP();
  start();
  const std::string glb = asset::test::bytes_of(*data / "gltf/pmndrs/pmndrs.glb");
  const auto before = unwrap(glb, "texcoord=1");
  const auto after = unwrap(glb, "textures=transfer");
  ASSERT_TRUE(before && after);
  ASSERT_EQ(before->status, 200) << before->body;
  ASSERT_EQ(after->status, 200) << after->body;
  EXPECT_NE(after->get_header_value("Unwrapd-Report").find("textures_transferred"),
            std::string::npos);
  const test::TexturedScene old_scene(before->body), new_scene(after->body);
  for (const Vec3& direction : test::eight_sides()) {
    const test::Compared compared =
        test::compare(old_scene, new_scene, direction, test::Look::base_colour, kSize);
    EXPECT_LE(compared.mean_difference, kMostDifference);
    EXPECT_GE(compared.share_compared, 0.4);
  }
}

TEST_F(TransferredTextures, AreRefusedByNameWhereTheyCannotBeRead) {
  start();
  const auto with_image = [](const std::string& bytes) {
    asset::test::Builder b = asset::test::square();
    b.json["images"] = {{{"bufferView", b.add_view(bytes)}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
    asset::test::Json& primitive = b.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["attributes"]["TEXCOORD_0"] = b.add("VEC2", 5126, {0, 0, 1, 0, 1, 1, 0, 1});
    return b.glb();
  };
  expect_problem(unwrap(with_image("\xabKTX 20\xbb\r\n\x1a\n"), "textures=transfer"), 422,
                 "unsupported_image");
  expect_problem(unwrap(with_image("\x89PNG\r\n\x1a\n"), "textures=transfer"), 400,
                 "malformed_image");
  const auto kept = unwrap(with_image("\xabKTX 20\xbb\r\n\x1a\n"), "textures=keep");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->status, 200);
}

}  // namespace
}  // namespace unwrapd::server
