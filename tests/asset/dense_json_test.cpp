// JSON of nothing but tiny values takes many times its bytes: the documented bound holds for it,
// and a server's own is kept before the memory is taken.
#include "tests/asset/memory_guard.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

constexpr std::size_t kListBytes = std::size_t{3} << 20;
constexpr std::size_t kFreeMemory = std::size_t{64} << 20;

/// A list of so many bytes with nothing but this in it.
std::string list_of(const std::string& value) {
  std::string list = "[" + value;
  while (list.size() < kListBytes) list += ',' + value;
  return list + "]";
}

/// The square with this text in the place of a mark.
std::string square_with(const std::string& text, const char* place) {
  Builder b = square();
  b.json["materials"] = {{{"name", "a"}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  b.json[Json::json_pointer(place)] = "@";
  std::string file = b.gltf();
  return file.replace(file.find("\"@\""), 3, text);
}

void expect_within_bound(const std::string& file, Compression compression) {
  const MemoryPeak peak;
  try {
    const Asset asset = read({file, {}}, {}, {.compression = compression});
    for (const Format format : {Format::glb, Format::gltf})
      write(asset, split_nowhere(asset), format);
  } catch (const Error& error) {
    EXPECT_TRUE(error.code() == ErrorCode::too_much_memory ||
                error.code() == ErrorCode::malformed_gltf)
        << error.what();
  }
  EXPECT_LE(peak.bytes(), kFreeMemory + 40 * file.size());
}

TEST(DenseJson, KeepsTheBoundWhereverItStands) {
  const std::string nested = std::string(100, '[') + std::string(100, ']');
  for (const std::string value : {"\"\"", "{}", "[\"\"]"})
    for (const char* place : {"/extras", "/materials/0/extras"}) {
      SCOPED_TRACE(value + " in " + place);
      expect_within_bound(square_with(list_of(value), place), Compression::none);
    }
  for (const char* place : {"/extras", "/nodes", "/materials/0/extras"})
    expect_within_bound(square_with(list_of(place == std::string("/nodes") ? "{}" : nested), place),
                        Compression::draco);
}

TEST(DenseJson, IsRefusedBeforeItTakesMoreThanAJobMay) {
  const std::string file = square_with(list_of("0"), "/extras");
  constexpr std::size_t kMost = std::size_t{16} << 20;
  const MemoryPeak peak;
  EXPECT_EQ(error_of(file, {.max_bytes = kMost}).code(), ErrorCode::too_much_memory);
  EXPECT_LE(peak.bytes(), std::size_t{1} << 20);
  EXPECT_NO_THROW(read({file, {}}, {}));
}

TEST(DenseJson, OrdinaryDocumentsAreFarFromIt) {
  Builder b = square();
  for (int i = 0; i < 100'000; ++i) {
    b.json["nodes"].push_back({{"mesh", 0}, {"translation", {i, 0, 1}}});
    b.json["scenes"][0]["nodes"].push_back(i + 1);
  }
  EXPECT_NO_THROW(read_file(b.glb()));
}

}  // namespace
}  // namespace unwrapd::asset::test
