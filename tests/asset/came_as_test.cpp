// What is no matter of texture coordinates goes out as it came in: modes, compressions and their
// names, fallbacks, images.
#include <meshoptimizer.h>

#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

const std::string kDraco = "KHR_draco_mesh_compression";

std::string answer_as_it_came(const std::string& file) {
  const Asset asset = read_file(file, {});
  return write(asset, split_nowhere(asset), Format::glb);
}

std::string packed(const std::string& file, Compression compression) {
  const Asset asset = read_file(file, {.compression = compression});
  return write(asset, split_nowhere(asset), Format::glb);
}

std::string bin_of(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  return glb.substr(28 + length);
}

bool lists(const Json& document, const char* list, const std::string& name) {
  return document.contains(list) && std::ranges::count(document[list], Json(name)) == 1;
}

TEST(CameAs, AModeThatIsWrittenOutStays) {
  Builder b = square();
  b.json["meshes"][0]["primitives"][0]["mode"] = 4;
  const std::string draco = packed(b.glb(), Compression::draco);
  for (const std::string& file : {b.glb(), draco})
    for (const AssetOptions& options : {kPlain, AssetOptions{}}) {
      const Asset asset = read_file(file, options);
      for (const auto& unwrapped : {split_nowhere(asset), split_everywhere(asset)}) {
        const Json document = json_of(write(asset, unwrapped, Format::glb));
        EXPECT_EQ(document["meshes"][0]["primitives"][0].value("mode", -1), 4);
      }
    }
}

/// A grid with its plain accessors and, for those that can read it, a bitstream.
std::string with_optional_draco() {
  const std::string draco = packed(grid(4).glb(), Compression::draco);
  const Json source = json_of(draco);
  const Json extension = source["meshes"][0]["primitives"][0]["extensions"][kDraco];
  const Json view = source["bufferViews"][extension["bufferView"].get<std::size_t>()];
  Builder b = grid(4);
  const std::size_t at = b.add_view(bin_of(draco).substr(view.value("byteOffset", std::size_t{0}),
                                                         view["byteLength"].get<std::size_t>()));
  b.json["meshes"][0]["primitives"][0]["extensions"][kDraco] = {
      {"bufferView", at}, {"attributes", {{"POSITION", extension["attributes"]["POSITION"]}}}};
  b.json["extensionsUsed"] = {kDraco};
  return b.glb();
}

TEST(CameAs, OptionalDracoStaysOptionalAndKeepsAFallback) {
  const std::string answer = answer_as_it_came(with_optional_draco());
  const Json document = json_of(answer);
  EXPECT_TRUE(lists(document, "extensionsUsed", kDraco));
  EXPECT_FALSE(document.contains("extensionsRequired"));
  EXPECT_TRUE(document["meshes"][0]["primitives"][0]["extensions"].contains(kDraco));
  const auto plain = read_naively(grid(4).glb()), fallback = read_naively(answer);
  ASSERT_EQ(fallback[0].faces.size(), plain[0].faces.size());
  for (std::size_t t = 0; t < plain[0].faces.size(); ++t)
    EXPECT_EQ(fallback[0].faces[t].at("POSITION"), plain[0].faces[t].at("POSITION"));
  EXPECT_TRUE(lists(json_of(packed(with_optional_draco(), Compression::draco)),
                    "extensionsRequired", kDraco));
}

TEST(CameAs, ABitstreamIsDecodedOnceForAllIndicesThatNameIt) {
  const std::string draco = packed(grid(4).glb(), Compression::draco);
  Builder b;
  b.json = json_of(draco);
  b.bin = bin_of(draco);
  Json& primitives = b.json["meshes"][0]["primitives"];
  const Json primitive = primitives[0];
  const Json indices = b.json["accessors"][primitive["indices"].get<std::size_t>()];
  for (int i = 0; i < 50; ++i) {
    b.json["accessors"].push_back(indices);
    b.json["accessors"].back()["name"] = std::to_string(i);
    primitives.push_back(primitive);
    primitives.back()["indices"] = b.json["accessors"].size() - 1;
  }
  const Asset asset = read_file(b.glb());
  EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 51 * 32);
  const Json document = json_of(write(asset, split_nowhere(asset), Format::glb));
  EXPECT_LE(document["bufferViews"].size(), 4U);
}

std::string renamed(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); from != to && at != std::string::npos; at = text.find(from))
    text.replace(at, from.size(), to);
  return text;
}

TEST(CameAs, MeshoptKeepsItsName) {
  const std::string ext = "EXT_meshopt_compression", khr = "KHR_meshopt_compression";
  const std::string file = packed(grid(20).glb(), Compression::meshopt);
  for (const std::string& name : {ext, khr}) {
    const std::string answer = answer_as_it_came(renamed(file, ext, name));
    EXPECT_TRUE(lists(json_of(answer), "extensionsRequired", name));
    EXPECT_TRUE(lists(json_of(answer), "extensionsUsed", name));
    EXPECT_EQ(answer.find(name == ext ? khr : ext), std::string::npos);
    EXPECT_EQ(read_file(answer).surfaces()[0].mesh.face_count(), 800);
  }
  EXPECT_TRUE(lists(json_of(packed(renamed(file, ext, khr), Compression::meshopt)),
                    "extensionsRequired", ext));
}

/// The corners of a face in any order: meshopt turns triangles.
std::set<std::vector<double>> turned_free(const Face& face) {
  const auto& corners = face.at("POSITION");
  return {corners.begin(), corners.end()};
}

TEST(CameAs, OptionalMeshoptStaysOptionalAndKeepsAFallback) {
  const std::string file = packed(grid(20).glb(), Compression::meshopt);
  Builder b;
  b.json = json_of(file);
  b.bin = bin_of(file);
  b.json.erase("extensionsRequired");
  b.json["buffers"][1]["uri"] = "data:application/octet-stream;base64,AAAA";  // is not looked at
  const std::string answer = answer_as_it_came(b.glb());
  EXPECT_FALSE(json_of(answer).contains("extensionsRequired"));
  EXPECT_TRUE(lists(json_of(answer), "extensionsUsed", "EXT_meshopt_compression"));
  const auto plain = read_naively(grid(20).glb()), fallback = read_naively(answer);
  ASSERT_EQ(fallback[0].faces.size(), plain[0].faces.size());
  for (std::size_t t = 0; t < plain[0].faces.size(); ++t)
    EXPECT_EQ(turned_free(fallback[0].faces[t]), turned_free(plain[0].faces[t]));
}

/// The specification's formula, once more: what a code stands for, in units of `most`.
std::array<long, 3> decoded(const std::array<long, 3>& code, long double most) {
  long double x = static_cast<long double>(code[0]) / static_cast<long double>(code[2]);
  long double y = static_cast<long double>(code[1]) / static_cast<long double>(code[2]);
  const long double z = 1 - fabsl(x) - fabsl(y);
  if (z < 0) {
    x = x >= 0 ? x + z : x - z;
    y = y >= 0 ? y + z : y - z;
  }
  const long double scale = most / hypotl(hypotl(x, y), z);
  return {lroundl(x * scale), lroundl(y * scale), lroundl(z * scale)};
}

template <class Integer>
void expect_exact_normals(int component_type) {
  std::mt19937 random(3);
  const long most = std::numeric_limits<Integer>::max();
  constexpr std::size_t kCount = 4096;
  std::vector<std::array<Integer, 4>> codes(kCount);
  std::vector<std::array<long, 3>> expected;
  for (auto& code : codes) {
    const long one = most >> random() % 3;
    const auto pick = [&] { return static_cast<long>(random() % (2 * one + 1)) - one; };
    const std::array<long, 3> given{pick(), pick(), one};
    for (std::size_t k = 0; k < 3; ++k) code[k] = static_cast<Integer>(given[k]);
    expected.push_back(decoded(given, static_cast<long double>(most)));
  }
  std::string stream(meshopt_encodeVertexBufferBound(kCount, sizeof codes[0]), '\0');
  stream.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(stream.data()),
                                           stream.size(), codes.data(), kCount, sizeof codes[0]));
  Builder b;
  const std::size_t positions = b.add("VEC3", 5126, std::vector<double>(3 * kCount, 1));
  const std::size_t at = (b.bin.size() + 3) / 4 * 4, view = b.add_view(stream);
  b.json["bufferViews"][view] = {
      {"buffer", 0}, {"byteLength", kCount * sizeof codes[0]}, {"byteStride", sizeof codes[0]}};
  b.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 0},
      {"byteOffset", at},
      {"byteLength", stream.size()},
      {"count", kCount},
      {"byteStride", sizeof codes[0]},
      {"mode", "ATTRIBUTES"},
      {"filter", "OCTAHEDRAL"}};
  b.json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", component_type},
                                 {"normalized", true},
                                 {"count", kCount},
                                 {"type", "VEC3"}});
  std::vector<double> corners(kCount - kCount % 3);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<double>(i);
  const std::size_t normals = b.json["accessors"].size() - 1;
  const std::size_t indices = b.add("SCALAR", 5125, corners);
  b.add_primitive({{"POSITION", positions}, {"NORMAL", normals}}, indices);
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const Asset asset = read_file(b.glb());
  const auto read = read_naively(write(asset, split_nowhere(asset), Format::glb));
  int wrong = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = read[0].faces[i / 3].at("NORMAL")[i % 3][k];
      wrong += std::lround(value * static_cast<double>(most)) == expected[i][k] ? 0 : 1;
    }
  EXPECT_EQ(wrong, 0);
}

TEST(CameAs, OctahedralNormalsAreWhatTheSpecificationSays) {
  expect_exact_normals<std::int8_t>(5120);
  expect_exact_normals<std::int16_t>(5122);
}

const std::string kPng = std::string("\x89PNG\r\n\x1a\n", 8) + "and more";

TEST(CameAs, AGlbTakesTheImagesAlongThatWereSent) {
  Builder b = square();
  b.json["images"] = {{{"uri", "a%20b.png"}}, {{"uri", "data:image/png;base64,AAAA"}}};
  const std::string file = b.gltf();
  const Asset asset = read(Input{file, {{"a b.png", kPng}}}, {});
  const std::string glb = write(asset, split_nowhere(asset), Format::glb);
  const Json document = json_of(glb), image = document["images"][0];
  EXPECT_FALSE(image.contains("uri"));
  EXPECT_EQ(image["mimeType"], "image/png");
  const Json view = document["bufferViews"][image["bufferView"].get<std::size_t>()];
  EXPECT_EQ(bin_of(glb).substr(view["byteOffset"].get<std::size_t>(), kPng.size()), kPng);
  EXPECT_EQ(document["images"][1], b.json["images"][1]);
  EXPECT_TRUE(side_effects(asset, split_nowhere(asset), Format::glb).empty());
  EXPECT_EQ(json_of(write(asset, split_nowhere(asset), Format::gltf))["images"], b.json["images"]);
}

std::vector<Note> notes_of(const std::string& file, Format output) {
  const Asset asset = read_file(file);
  return side_effects(asset, split_nowhere(asset), output);
}

TEST(CameAs, ANoteNamesImagesThatStayBeside) {
  Builder b = square();
  b.json["images"] = {{{"uri", "a.png"}}};
  const std::vector<Note> notes = notes_of(b.gltf(), Format::glb);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].code, NoteCode::images_separate);
  EXPECT_NE(notes[0].text.find("a.png"), std::string::npos);
  EXPECT_TRUE(notes_of(b.gltf(), Format::gltf).empty());
  EXPECT_TRUE(notes_of(b.glb(), Format::glb).empty());
}

}  // namespace
}  // namespace unwrapd::asset::test
