// The hostile files: each gets a clean answer, at once, and without the memory that it asks for.
#include <set>

#include "tests/asset/memory_guard.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

constexpr std::size_t kMaxBeyondNeed = std::size_t{64} << 20;

/// What a file of this size may need for itself: the text of its JSON costs the most.
std::size_t need_of(std::size_t bytes) { return 40 * bytes; }

enum class Outcome { read, refused };

/// Reads a file, and writes it with every vertex split when it can be read.
Outcome outcome_of(const std::string& document, const std::map<std::string, std::string>& buffers) {
  std::size_t size = document.size();
  for (const auto& [uri, bytes] : buffers) size += bytes.size();
  const MemoryPeak peak;
  Outcome outcome = Outcome::read;
  try {
    const Asset asset = read(input_of(document, buffers), {});
    for (const Surface& surface : asset.surfaces()) {
      EXPECT_EQ(surface.part.size(), surface.mesh.faces.size());
      for (const Vec3& position : surface.mesh.positions) EXPECT_TRUE(position.allFinite());
      for (const Triangle& face : surface.mesh.faces)
        for (const Index vertex : face)
          EXPECT_TRUE(vertex >= 0 && vertex < surface.mesh.vertex_count());
    }
    const std::vector<UnwrappedSurface> unwrapped = split_everywhere(asset);
    for (const Format format : {Format::glb, Format::gltf, Format::obj})
      EXPECT_FALSE(write(asset, unwrapped, format).empty());
  } catch (const Error& error) {
    EXPECT_FALSE(std::string(error.what()).empty());
    EXPECT_NE(error.code(), ErrorCode::internal);
    outcome = Outcome::refused;
  }
  EXPECT_LE(peak.bytes(), kMaxBeyondNeed + need_of(size));
  return outcome;
}

/// A bitstream wrapped into a glTF that claims nothing about it.
std::string wrapped(const std::string& bitstream) {
  Builder b;
  const std::size_t view = b.add_view(bitstream);
  b.json["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
  b.add_primitive({{"POSITION", 0}})["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  return b.glb();
}

/// Sound to asset, refused by core: no area, or no orientation, or not a mesh that can be cut.
const std::set<std::string> kLeftToCore = {
    "06_all_zero_positions.glb", "07_collinear.glb",
    "23_sparse_index_oob.glb",   "a0_fan_3_faces_one_edge.glb",
    "a1_bowtie_vertex.glb",      "a3_moebius.glb",
    "a5_duplicate_face.glb",     "a6_repeated_index_face.glb",
    "a7_two_components.glb",     "b0_no_faces.glb"};

bool must_be_read(const std::string& verdict) {
  return verdict == "OK" || verdict.starts_with("OK:");
}

bool must_be_refused(const std::string& verdict) {
  return verdict.starts_with("reject") && !verdict.starts_with("reject/") &&
         verdict.find(" or ") == std::string::npos;
}

TEST(Hostile, EveryMadeFileGetsWhatIsExpected) {
  const auto data = test_data();
  if (!data) GTEST_SKIP() << "no test data";
  const std::filesystem::path folder = *data / "hostile/made";
  const Json expected = Json::parse(bytes_of(folder / "EXPECTED.json"));
  int seen = 0;
  for (const auto& [name, verdict] : expected.items()) {
    if (!std::filesystem::exists(folder / name)) continue;  // too large to keep: made below
    SCOPED_TRACE(name);
    ++seen;
    const std::string file = bytes_of(folder / name);
    const bool is_draco = name.ends_with(".drc");
    if (is_draco) {
      EXPECT_EQ(error_of(file).code(), ErrorCode::unknown_format);
    }
    const Outcome outcome = outcome_of(is_draco ? wrapped(file) : file, {});
    if (must_be_read(verdict)) {
      EXPECT_EQ(outcome, Outcome::read);
    }
    if (must_be_refused(verdict) && !kLeftToCore.contains(name)) {
      EXPECT_EQ(outcome, Outcome::refused);
    }
  }
  EXPECT_GT(seen, 180);
}

TEST(Hostile, OtherPeoplesBrokenFilesGetACleanAnswer) {
  const auto data = test_data();
  if (!data) GTEST_SKIP() << "no test data";
  int seen = 0;
  for (const char* folder : {"hostile/validator", "hostile/tinygltf"})
    for (const auto& file : files_below(*data / folder, {".gltf", ".glb"})) {
      SCOPED_TRACE(file);
      outcome_of(bytes_of(file), buffers_beside(file));
      ++seen;
    }
  for (const auto& file : files_below(*data / "hostile/draco_bitstreams", {".drc"})) {
    SCOPED_TRACE(file);
    outcome_of(wrapped(bytes_of(file)), {});
    ++seen;
  }
  EXPECT_GT(seen, 390);
}

TEST(Hostile, SmallFilesThatAskForMuchGetLittle) {
  Builder b = square();
  const Json primitive = b.json["meshes"][0]["primitives"][0];
  for (int i = 0; i < 100'000; ++i) b.json["meshes"][0]["primitives"].push_back(primitive);
  EXPECT_EQ(outcome_of(b.glb(), {}), Outcome::read);

  b = grid(100);  // ten thousand accessors over the same bytes, each a pool of its own
  for (int i = 0; i < 10'000; ++i) {
    b.json["accessors"].push_back(b.json["accessors"][0]);
    b.add_primitive({{"POSITION", 0}, {"_X", b.json["accessors"].size() - 1}}, 1);
  }
  EXPECT_EQ(outcome_of(b.glb(), {}), Outcome::refused);

  b = square();  // a hundred thousand sparse accessors over the same bytes
  b.add_view(std::string("\0\0\1\0\2\0\3\0", 8));
  b.json["accessors"][0]["sparse"] = {{"count", 4},
                                      {"indices", {{"bufferView", 2}, {"componentType", 5123}}},
                                      {"values", {{"bufferView", 0}}}};
  for (int i = 0; i < 100'000; ++i) b.json["accessors"].push_back(b.json["accessors"][0]);
  EXPECT_EQ(outcome_of(b.glb(), {}), Outcome::refused);

  b = square();  // morph targets without data, one after another
  b.json["accessors"].push_back({{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  Json& targets = b.json["meshes"][0]["primitives"][0]["targets"];
  for (int i = 0; i < 10'000; ++i) targets.push_back({{"POSITION", 2}});
  EXPECT_EQ(outcome_of(b.glb(), {}), Outcome::read);
}

TEST(Hostile, AnObjWithAHugePolygonIsReadAtOnce) {
  std::string text;
  std::string face = "f";
  for (int i = 1; i <= 200'000; ++i) {
    text += "v " + std::to_string(i) + " " + std::to_string(i % 7) + " 0\n";
    face += ' ' + std::to_string(i);
  }
  EXPECT_EQ(outcome_of(text + face, {}), Outcome::read);
}

}  // namespace
}  // namespace unwrapd::asset::test
