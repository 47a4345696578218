#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using Names = std::vector<std::string>;

Names names_of(const std::string& file) {
  Asset asset = read_file(file);
  EXPECT_TRUE(asset.surfaces()[0].materials.empty());
  name_materials(asset);
  return asset.surfaces()[0].materials;
}

TEST(NameMaterials, OfAGltfAreJsonPointersByPrimitive) {
  Builder b = square();
  b.json["materials"] = Json::parse(R"([{"name": "a"}, {"name": "a"}, {}])");
  Json& primitives = b.json["meshes"][0]["primitives"];
  primitives[0]["material"] = 2;
  const std::size_t other = b.add("VEC3", 5126, {0, 0, 1, 1, 0, 1, 0, 1, 1});
  b.add_primitive({{"POSITION", other}});
  EXPECT_EQ(names_of(b.glb()), (Names{"/materials/2", ""}));
  b.json["meshes"][0]["primitives"][1]["material"] = 0;
  EXPECT_EQ(names_of(b.glb()), (Names{"/materials/2", "/materials/0"}));
}

TEST(NameMaterials, OfAnObjAreItsNames) {
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nusemtl dark wood\nf 2 4 3\n";
  EXPECT_EQ(names_of(obj), (Names{"", "dark wood"}));
  EXPECT_EQ(names_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl unused\n"), (Names{""}));
}

TEST(NameMaterials, OtherFormatsHaveNone) {
  EXPECT_EQ(names_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), (Names{""}));
}

}  // namespace
}  // namespace unwrapd::asset::test
