// Which set of texture coordinates is written where the caller names none.
#include <tuple>

#include "core/base/error.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

constexpr int kSets = kMaxTexcoord + 1;

const AssetOptions kAutomatic = {.texcoord = TexcoordChoice::automatic,
                                 .compression = Compression::none};
const AssetOptions kFree = {.texcoord = TexcoordChoice::free, .compression = Compression::none};

Json texture_of(int set) { return {{"index", 0}, {"texCoord", set}}; }

/// A square that has the sets below `present`, and a material whose texture samples `sampled`.
Builder with_sets(int present, int sampled) {
  Builder b = square();
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  for (int set = 0; set < present; ++set)
    primitive["attributes"]["TEXCOORD_" + std::to_string(set)] =
        b.add("VEC2", 5126, {0, 0, 1, 0, 1, 1, 0, 1});
  primitive["material"] = 0;
  b.json["textures"] = {Json::object()};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture_of(sampled)}}}}};
  return b;
}

std::vector<NoteCode> codes(const Asset& asset) {
  std::vector<NoteCode> found;
  for (const Note& note : side_effects(asset, split_nowhere(asset), Format::glb))
    found.push_back(note.code);
  return found;
}

TEST(ChooseTexcoord, IsZeroWhereNoTextureSamplesIt) {
  for (const std::string& file : {square().glb(), with_sets(2, 1).glb()}) {
    const Asset asset = read_file(file, kAutomatic);
    EXPECT_EQ(asset.texcoord(), 0);
    EXPECT_TRUE(codes(asset).empty());
  }
}

TEST(ChooseTexcoord, IsTheFirstFreeOneWhereATextureSamplesZero) {
  const Builder b = with_sets(2, 0);
  const Asset asset = read_file(b.glb(), kAutomatic);
  EXPECT_EQ(asset.texcoord(), 2);
  EXPECT_EQ(codes(asset), std::vector{NoteCode::set_chosen});
  const Json after = json_of(write(asset, split_nowhere(asset), Format::glb));
  EXPECT_TRUE(after["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_2"));
  EXPECT_EQ(after["materials"], b.json["materials"]);
}

TEST(ChooseTexcoord, FollowsTheSetOfAnExtensionAndOfVariants) {
  Builder moved = with_sets(2, 1);
  Json& info = moved.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  info["extensions"]["KHR_texture_transform"] = {{"texCoord", 0}};
  moved.json["extensionsUsed"] = {"KHR_texture_transform"};
  EXPECT_EQ(read_file(moved.glb(), kAutomatic).texcoord(), 2);
  Builder variant = with_sets(2, 1);
  variant.json["materials"].push_back({{"normalTexture", texture_of(0)}});
  variant.json["extensionsUsed"] = {"KHR_materials_variants"};
  variant.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "other"}}};
  variant.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  EXPECT_EQ(read_file(variant.glb(), kAutomatic).texcoord(), 2);
}

TEST(ChooseTexcoord, IsZeroWhereTheTextureHasNoCoordinatesToFit) {
  EXPECT_EQ(read_file(with_sets(0, 0).glb(), kAutomatic).texcoord(), 0);
}

TEST(ChooseTexcoord, LooksAtWhatIsUnwrappedAlone) {
  Builder b = with_sets(1, 0);
  Json plain = b.json["meshes"][0]["primitives"][0];
  plain.erase("material");
  b.json["meshes"][0]["primitives"].push_back(plain);
  AssetOptions second = kAutomatic;
  second.primitives = {"/meshes/0/primitives/1"};
  EXPECT_EQ(read_file(b.glb(), second).texcoord(), 0);
  EXPECT_EQ(read_file(b.glb(), kAutomatic).texcoord(), 1);
}

TEST(ChooseTexcoord, AFreeSetIsOneThatNothingHas) {
  EXPECT_EQ(read_file(square().glb(), kFree).texcoord(), 0);
  EXPECT_EQ(read_file(with_sets(1, 1).glb(), kFree).texcoord(), 1);
  const Asset asset = read_file(with_sets(3, 0).glb(), kFree);
  EXPECT_EQ(asset.texcoord(), 3);
  EXPECT_EQ(codes(asset), std::vector{NoteCode::set_chosen});
}

TEST(ChooseTexcoord, WhenAllAreThereItIsOneThatNoTextureSamples) {
  const Asset asset = read_file(with_sets(kSets, 0).glb(), kAutomatic);
  EXPECT_EQ(asset.texcoord(), 1);
  Builder b = with_sets(kSets, 0);
  for (int set = 1; set < kSets; ++set)
    b.json["materials"][0]["extensions"]["KHR_x"]["t" + std::to_string(set) + "Texture"] =
        texture_of(set);
  try {
    read_file(b.glb(), kAutomatic);
    FAIL() << "a set was chosen that a texture samples";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_option);
    EXPECT_EQ(error.where(), "/texcoord");
  }
}

TEST(ChooseTexcoord, ASetThatHadToMakeRoomIsNamed) {
  for (const auto& [sampled, options, set] :
       {std::tuple(0, kAutomatic, 1), {0, kFree, 1}, {3, kFree, 0}}) {
    const Asset asset = read_file(with_sets(kSets, sampled).glb(), options);
    EXPECT_EQ(asset.texcoord(), set);
    const std::vector<Note> notes = side_effects(asset, split_nowhere(asset), Format::glb);
    ASSERT_EQ(notes.size(), 1U) << sampled;
    EXPECT_EQ(notes[0].code, NoteCode::set_chosen);
    const std::string name = "TEXCOORD_" + std::to_string(set);
    EXPECT_NE(notes[0].text.find("replace " + name), std::string::npos) << notes[0].text;
    EXPECT_EQ(notes[0].text.find("existing sets stay"), std::string::npos) << notes[0].text;
  }
}

TEST(ChooseTexcoord, ANamedSetThatTexturesSampleIsToldAsALoss) {
  const Asset asset = read_file(with_sets(1, 0).glb());
  EXPECT_EQ(asset.texcoord(), 0);
  EXPECT_EQ(codes(asset), std::vector{NoteCode::textures_lost});
}

TEST(ChooseTexcoord, AnObjWithMaterialsAndCoordinatesLosesTheFitOfItsImages) {
  const auto loses_textures = [](const std::string& obj) {
    const std::vector<NoteCode> told = codes(read_file(obj, kAutomatic));
    return std::ranges::count(told, NoteCode::textures_lost) == 1;
  };
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_TRUE(loses_textures(triangle + "vt 0 0\nusemtl wood\nf 1/1 2/1 3/1\n"));
  EXPECT_FALSE(loses_textures(triangle + "vt 0 0\nf 1/1 2/1 3/1\n"));
  EXPECT_FALSE(loses_textures(triangle + "usemtl wood\nf 1 2 3\n"));
}

TEST(ChooseTexcoord, ExistingUvsAreReadFromTheFirstSet) {
  Asset asset = read_file(with_sets(2, 0).glb(), kAutomatic);
  read_uvs(asset);
  ASSERT_FALSE(asset.surfaces()[0].corner_uv.empty());
  EXPECT_TRUE(asset.surfaces()[0].corner_uv[0][0].allFinite());
}

}  // namespace
}  // namespace unwrapd::asset::test
