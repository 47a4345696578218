// Real and made assets, before and after their textures were transferred, from eight sides.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/asset/asset.hpp"
#include "core/texture/codec.hpp"
#include "core/unwrap.hpp"
#include "tests/pipeline/textured_scene.hpp"

namespace unwrapd::test {
namespace {

using asset::test::Builder;

constexpr double kMostDifference = 2;  // of 255, mean over pixels away from seams
constexpr double kMostNearSeams = 1;
constexpr int kSize = 160;  // pixels

const UnwrapOptions kTexture = {.max_distortion = 2.02, .guarantee = Guarantee::bijective};

struct Pair {
  TexturedScene before, after;
};

std::string written(const std::string& file, const AssetOptions& options) {
  const asset::Asset asset = asset::read({file, {}}, {}, options);
  SerialExecutor serial;
  UnwrapOptions on_page = kTexture;
  on_page.width = options.page.width;
  on_page.height = options.page.height;
  const Unwrapped u = unwrap(asset.surfaces(), on_page, {}, serial);
  return asset::write(asset, u.surfaces, asset::Format::glb);
}

/// The asset with the new coordinates in another set, and with transferred textures.
Pair transferred(const std::string& file, const PageSize& page = {}) {
  AssetOptions options{.texcoord = 7, .compression = Compression::none, .page = page};
  const std::string before = written(file, options);
  options.texcoord = TexcoordChoice::automatic;
  options.textures = TextureMode::transfer;
  return {TexturedScene(before), TexturedScene(written(file, options))};
}

/// UNWRAPD_PICTURES: a folder to look at.
void save(const std::string& name, const texture::Image& image) {
  const char* folder = std::getenv("UNWRAPD_PICTURES");
  if (folder == nullptr) return;
  std::ofstream file(std::string(folder) + "/" + name + ".png", std::ios::binary);
  file << texture::encode(image, {.width = image.width, .height = image.height}, {});
}

void expect_same_look(const Pair& pair, Look look, const std::string& name) {
  ASSERT_EQ(pair.before.faces().size(), pair.after.faces().size());
  int side = 0;
  for (const Vec3& direction : eight_sides()) {
    const Compared compared = compare(pair.before, pair.after, direction, look, kSize);
    save(name + std::to_string(side) + "_before", compared.before);
    save(name + std::to_string(side) + "_after", compared.after);
    std::printf("%s, side %d: %.3f of 255 over %.0f %% of the pixels, %.3f near seams\n",
                name.c_str(), side++, compared.mean_difference, 100 * compared.share_compared,
                compared.near_seams);
    EXPECT_LE(compared.mean_difference, kMostDifference);
    EXPECT_LE(compared.near_seams, kMostNearSeams);
    EXPECT_GE(compared.share_compared, 0.4);
  }
}

/// A bent plate with a bump: its UVs repeat the images, turned by a transform.
Builder plate(int n, const std::string& colour, const std::string& normal) {
  std::vector<double> points, normals, uvs, tangents, corners;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const double u = double(x) / n, v = double(y) / n, a = 4.4 * u,
                   r = 1 + 0.15 * std::sin(7 * v);
      const double slope = 0.15 * 7 * std::cos(7 * v) / 2;
      points.insert(points.end(), {r * std::sin(a), 2 * v - 1, r * std::cos(a)});
      const Vec3 up = Vec3(std::sin(a), -slope, std::cos(a)).normalized();
      normals.insert(normals.end(), {up.x(), up.y(), up.z()});
      tangents.insert(tangents.end(), {std::cos(a), 0, -std::sin(a), 1});
      uvs.insert(uvs.end(), {1.7 * u - 0.3, 1.2 - v});
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x, b = a + n + 1;
      for (const int corner : {a, a + 1, b + 1, a, b + 1, b}) corners.push_back(corner);
    }
  Builder plate;
  const std::size_t position = plate.add("VEC3", 5126, points);
  plate.json["accessors"][position]["min"] = {-2, -2, -2};
  plate.json["accessors"][position]["max"] = {2, 2, 2};
  plate.add_primitive({{"POSITION", position},
                       {"NORMAL", plate.add("VEC3", 5126, normals)},
                       {"TANGENT", plate.add("VEC4", 5126, tangents)},
                       {"TEXCOORD_0", plate.add("VEC2", 5126, uvs)}},
                      plate.add("SCALAR", 5125, corners));
  plate.json["meshes"][0]["primitives"][0]["material"] = 0;
  plate.json["extensionsUsed"] = {"KHR_texture_transform"};
  for (const std::string& bytes : {colour, normal})
    plate.json["images"].push_back(
        {{"bufferView", plate.add_view(bytes)}, {"mimeType", "image/png"}});
  plate.json["samplers"] = {{{"wrapS", 33648}}};
  plate.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}}};
  plate.json["materials"] = {{{"normalTexture", {{"index", 1}}}}};
  plate.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", 0},
      {"extensions",
       {{"KHR_texture_transform",
         {{"rotation", 0.4}, {"scale", {1.3, 0.8}}, {"offset", {0.1, -0.2}}}}}}};
  return plate;
}

/// Real images on the plate. with_tangents: in the file, and else as readers compute them.
std::string textured_plate(const std::filesystem::path& data, bool with_tangents) {
  const auto folder =
      data / "gltf/babylon/Tests/AssetGenerator/0.6/Mesh_PrimitiveAttribute/Textures";
  Builder made = plate(16, asset::test::bytes_of(folder / "BaseColor_Plane.png"),
                       asset::test::bytes_of(folder / "Normal_Plane.png"));
  if (!with_tangents) made.json["meshes"][0]["primitives"][0]["attributes"].erase("TANGENT");
  return made.glb();
}

TEST(TransferredTextures, ARealAssetLooksTheSameFromEightSides) {
  const auto data = asset::test::test_data();
  if (!data) GTEST_SKIP();
  const std::string file = asset::test::bytes_of(*data / "gltf/pmndrs/pmndrs.glb");
  expect_same_look(transferred(file), Look::base_colour, "pmndrs");
}

TEST(TransferredTextures, RepeatedTurnedAndMirroredImagesLookTheSame) {
  const auto data = asset::test::test_data();
  if (!data) GTEST_SKIP();
  const Pair pair = transferred(textured_plate(*data, true));
  expect_same_look(pair, Look::base_colour, "plate");
  expect_same_look(pair, Look::normals, "plate_normals");
}

TEST(TransferredTextures, LookTheSameOnAPageThatIsNotSquare) {
  const auto data = asset::test::test_data();
  if (!data) GTEST_SKIP();
  const Pair pair = transferred(textured_plate(*data, true), {512, 1536});
  expect_same_look(pair, Look::base_colour, "plate_on_high_page");
  expect_same_look(pair, Look::normals, "plate_normals_on_high_page");
}

TEST(TransferredTextures, NormalMapsFollowTheFramesThatReadersCompute) {
  const auto data = asset::test::test_data();
  if (!data) GTEST_SKIP();
  expect_same_look(transferred(textured_plate(*data, false)), Look::normals, "plate_computed");
}

}  // namespace
}  // namespace unwrapd::test
