// What tinygltf gets was looked at before, comes in slices, and loses nothing by that.
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

#include "core/asset/reader/read_gltf.hpp"
#include "tests/asset/memory_guard.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

/// The square with a sparse accessor, a morph target and a material: every number that is read.
Builder with_every_number() {
  Builder b = square();
  b.json["materials"] = {{{"name", "a"}}};
  b.json["bufferViews"][0]["byteStride"] = 12;
  b.add_view(std::string("\0\0\2\0", 4));
  b.json["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", 2}, {"byteOffset", 0}, {"componentType", 5123}}},
      {"values", {{"bufferView", 0}, {"byteOffset", 0}}}};
  b.json["accessors"][0]["byteOffset"] = 0;
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["mode"] = 4;
  primitive["material"] = 0;
  primitive["targets"] = {{{"POSITION", 0}}};
  return b;
}

constexpr std::array kNumbers = {"/bufferViews/0/buffer",
                                 "/bufferViews/0/byteOffset",
                                 "/bufferViews/0/byteLength",
                                 "/bufferViews/0/byteStride",
                                 "/accessors/0/bufferView",
                                 "/accessors/0/byteOffset",
                                 "/accessors/0/componentType",
                                 "/accessors/0/count",
                                 "/accessors/0/sparse/count",
                                 "/accessors/0/sparse/indices/bufferView",
                                 "/accessors/0/sparse/indices/byteOffset",
                                 "/accessors/0/sparse/indices/componentType",
                                 "/accessors/0/sparse/values/bufferView",
                                 "/accessors/0/sparse/values/byteOffset",
                                 "/meshes/0/primitives/0/mode",
                                 "/meshes/0/primitives/0/material",
                                 "/meshes/0/primitives/0/indices",
                                 "/meshes/0/primitives/0/attributes/POSITION",
                                 "/meshes/0/primitives/0/targets/0/POSITION"};

TEST(TinyGltf, IsGivenNoNumberThatItWouldTakeForAnother) {
  const Builder good = with_every_number();
  const std::vector<Vec3> expected = read_file(good.glb()).surfaces()[0].mesh.positions;
  for (const char* const pointer : kNumbers) {
    const Json::json_pointer place(pointer);
    const Json number = good.json[place];
    const auto low_bits = (std::uint64_t{1} << 32) + number.get<std::uint64_t>();
    for (const Json& value : {Json(-4), Json("36"), Json(0.5), Json(nullptr), Json(low_bits)}) {
      Builder b = good;
      b.json[place] = value;
      const Error error = error_of(b.glb());
      EXPECT_EQ(error.code(), ErrorCode::malformed_gltf) << pointer << " = " << value;
      EXPECT_TRUE(std::string(pointer).starts_with(error.where())) << error.where();
      EXPECT_FALSE(error.where().empty()) << pointer << " = " << value;
    }
    Builder b = good;
    b.json[place] = number.get<double>();
    EXPECT_EQ(read_file(b.glb()).surfaces()[0].mesh.positions, expected) << pointer;
  }
}

TEST(TinyGltf, ReadsListsOfManySlicesAndTellsTheirFirstFault) {
  constexpr std::size_t kMany = 5'000;
  Builder b = square();
  for (std::size_t i = 2; i < kMany; ++i) {
    b.json["bufferViews"].push_back(b.json["bufferViews"][0]);
    b.json["accessors"].push_back(b.json["accessors"][0]);
    b.json["accessors"][i]["bufferView"] = i;
    b.add_primitive({{"POSITION", i}}, 1);
  }
  EXPECT_EQ(read_file(b.glb()).surfaces().size(), read_file(square().glb()).surfaces().size());
  for (const std::size_t first : {std::size_t{7}, kMany - 9}) {
    Builder bad = b;
    bad.json["accessors"][first]["count"] = 1'000'000;   // of a right kind, but out of range
    bad.json["accessors"][first + 1]["count"] = "many";  // found earlier
    EXPECT_EQ(error_of(bad.glb()).where(), "/accessors/" + std::to_string(first));
  }
}

TEST(TinyGltf, HoldsNoMoreOfADocumentThanASlice) {
  constexpr std::size_t kBytes = std::size_t{2} << 20;
  for (const auto& [list, element] :
       {std::pair("bufferViews", R"({"buffer":0,"byteLength":0})"),
        std::pair("accessors", R"({"count":1,"type":"VEC3","componentType":5126})")}) {
    std::string all = element;
    while (all.size() < kBytes) all.append(",").append(element);
    Builder b = square();
    b.json[list].push_back("@");
    std::string file = b.gltf();
    file.replace(file.find("\"@\""), 3, all);
    const MemoryPeak peak;
    EXPECT_NO_THROW(read_file(file));
    EXPECT_LE(peak.bytes(), 20 * file.size()) << list;
  }
}

TEST(TinyGltf, GetsNoPrimitiveOfEndlessNames) {
  Builder b = square();
  Json& targets = b.json["meshes"][0]["primitives"][0]["targets"];
  for (int i = 0; i < 65'536; ++i) targets.push_back({{"POSITION", 0}});
  EXPECT_EQ(error_of(b.glb()).where(), "/meshes/0/primitives/0/targets/65535");
}

/// The document as tinygltf reads it by itself, with zeros for what lies in files beside it; empty
/// when it does not.
std::optional<tinygltf::Model> read_whole(const std::string& file) {
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks(
      {[](const std::string&, void*) { return true; },
       [](const std::string& name, void*) { return name; },
       [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
       nullptr, nullptr});
  reader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int,
                           const unsigned char*, int, void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(file.size());
  const bool is_read =
      file.starts_with("glTF")
          ? reader.LoadBinaryFromMemory(&model, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(file.data()), size)
          : reader.LoadASCIIFromString(&model, &error, &warning, file.data(), size, "");
  return is_read ? std::optional(std::move(model)) : std::nullopt;
}

/// As asset reads it; empty for what it refuses, and for what was compressed, whose views change.
std::optional<Gltf> read_in_slices(const Input& input) try {
  const bool is_glb = input.document.starts_with("glTF");
  std::vector<Surface> surfaces;
  Gltf gltf = reader::read_gltf(input, is_glb ? Format::glb : Format::gltf, {}, {}, surfaces);
  const bool is_plain = gltf.came_as == Compression::none && gltf.spent_views.empty();
  return is_plain ? std::optional(std::move(gltf)) : std::nullopt;
} catch (const Error&) {
  return std::nullopt;
}

void expect_same(const Gltf& gltf, const tinygltf::Model& model) {
  ASSERT_EQ(gltf.views.size(), model.bufferViews.size());
  for (std::size_t i = 0; i < gltf.views.size(); ++i) {
    EXPECT_EQ(gltf.views[i].offset, model.bufferViews[i].byteOffset);
    EXPECT_EQ(gltf.views[i].length, model.bufferViews[i].byteLength);
    EXPECT_EQ(gltf.views[i].stride, model.bufferViews[i].byteStride);
  }
  ASSERT_EQ(gltf.accessors.size(), model.accessors.size());
  for (std::size_t i = 0; i < gltf.accessors.size(); ++i) {
    EXPECT_EQ(gltf.accessors[i].count, model.accessors[i].count);
    EXPECT_EQ(gltf.accessors[i].offset, model.accessors[i].byteOffset);
    EXPECT_EQ(int(gltf.accessors[i].type), model.accessors[i].componentType);
    EXPECT_EQ(gltf.accessors[i].sparse.has_value(), model.accessors[i].sparse.isSparse);
  }
  auto ours = gltf.primitives.begin();
  for (const tinygltf::Mesh& mesh : model.meshes)
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      ASSERT_NE(ours, gltf.primitives.end());
      EXPECT_EQ(ours->indices ? int(*ours->indices) : -1, primitive.indices);
      EXPECT_EQ(ours->material ? int(*ours->material) : -1, primitive.material);
      const std::map<std::string, int> attributes(ours->attributes.begin(), ours->attributes.end());
      EXPECT_EQ(attributes, primitive.attributes);
      ++ours;
    }
  EXPECT_EQ(ours, gltf.primitives.end());
}

TEST(TinyGltf, ReadsTheSameInSlicesAsInWholeDocuments) {
  const auto data = test_data();
  if (!data) GTEST_SKIP() << "no test data";
  int seen = 0;
  for (const auto& path : files_below(*data / "gltf", {".gltf", ".glb"})) {
    SCOPED_TRACE(path);
    const std::string file = bytes_of(path);
    const auto beside = buffers_beside(path);
    if (!beside.empty()) continue;  // tinygltf opens files, here none
    const auto model = read_whole(file);
    if (!model) continue;
    const std::optional<Gltf> gltf = read_in_slices(input_of(file, beside));
    if (!gltf) continue;
    expect_same(*gltf, *model);
    ++seen;
  }
  EXPECT_GT(seen, 30);
}

}  // namespace
}  // namespace unwrapd::asset::test
