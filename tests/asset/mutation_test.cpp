// Seeded damage to good files: whatever comes in, an answer or an Error comes out.
#include <random>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

std::string damaged(std::string file, std::mt19937& random) {
  const int cuts = static_cast<int>(random() % 4);
  for (int k = 0; k <= cuts && !file.empty(); ++k) {
    const std::size_t at = random() % file.size();
    const std::size_t length = 1 + random() % 8;
    switch (random() % 4) {
      case 0:
        file[at] = static_cast<char>(random());
        break;
      case 1:
        file.erase(at, length);
        break;
      case 2:
        file.insert(at, file.substr(random() % file.size(), length));
        break;
      default:
        file[at] = "0123456789-{}[],:\"e."[random() % 20];
    }
  }
  return file;
}

/// The JSON of a GLB damaged, the container right: most damage gets past the first check.
TEST(Mutation, DamagedDocumentsAreReadOrRefused) {
  std::mt19937 random(1);
  Builder b = grid(3);
  b.json["meshes"][0]["primitives"][0]["attributes"]["_A"] =
      b.add("SCALAR", 5126, std::vector<double>(16, 1));
  const std::string json = [&] {
    Json document = b.json;
    document["buffers"][0]["byteLength"] = b.bin.size();
    return document.dump();
  }();
  for (int k = 0; k < 4000; ++k) try_file(glb_of(damaged(json, random), b.bin));
  const std::string gltf = square().gltf();
  for (int k = 0; k < 2000; ++k) try_file(damaged(gltf, random));
}

/// One value of the document replaced by another of any kind.
TEST(Mutation, DocumentsWithForeignValuesAreReadOrRefused) {
  std::mt19937 random(2);
  const std::vector<Json> values = {nullptr, true,          -1,    0,          1,
                                    2,       3.5,           1e300, 4294967296, "POSITION",
                                    "",      Json::array(), {0},   {{"a", 0}}, Json::object(),
                                    65535,   5121,          5125};
  Builder b = grid(3);
  const Json flat = b.json.flatten();
  std::vector<std::string> pointers;
  for (const auto& [pointer, value] : flat.items()) pointers.push_back(pointer);
  for (int k = 0; k < 6000; ++k) {
    Builder bad = b;
    Json::json_pointer pointer(pointers[random() % pointers.size()]);
    while (random() % 3 == 0 && !pointer.parent_pointer().empty())
      pointer = pointer.parent_pointer();
    bad.json[pointer] = values[random() % values.size()];
    Json document = bad.json;
    if (document["buffers"].is_array() && !document["buffers"].empty() &&
        document["buffers"][0].is_object())
      document["buffers"][0]["byteLength"] = bad.bin.size();
    try_file(glb_of(document.dump(), bad.bin));
  }
}

TEST(Mutation, DamagedObjsAreReadOrRefused) {
  std::mt19937 random(3);
  const std::string text =
      "# x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n"
      "f -4//1 -2//1 -1//1\nf 1 2 \\\n3 4\nl 1 2\n";
  for (int k = 0; k < 10'000; ++k) try_file(damaged(text, random));
}

}  // namespace
}  // namespace unwrapd::asset::test
