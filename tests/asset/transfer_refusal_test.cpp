// What textures=transfer refuses, before anything is unwrapped.
#include "core/base/error.hpp"
#include "tests/asset/transfer_samples.hpp"

namespace unwrapd::asset::test {
namespace {

ErrorCode refusal(const std::string& file, const std::string& where,
                  const AssetOptions& options = kTransfer) {
  try {
    read_file(file, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), where);
    return error.code();
  }
  return ErrorCode::internal;
}

TEST(TransferRefusal, RefusesImagesItCannotReadByName) {
  EXPECT_EQ(refusal(textured("\xabKTX 20\xbb\r\n\x1a\n").glb(), "/images/0"),
            ErrorCode::unsupported_image);
  EXPECT_EQ(refusal(textured("\x89PNG\r\n\x1a\n").glb(), "/images/0"), ErrorCode::malformed_image);
  Builder basisu = textured("");
  basisu.json["extensionsUsed"] = {"KHR_texture_basisu"};
  basisu.json["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  EXPECT_EQ(refusal(basisu.glb(), "/textures/0"), ErrorCode::unsupported_image);
  Builder beside = textured("");
  beside.json["images"][0] = {{"uri", "wood.png"}};
  EXPECT_EQ(refusal(beside.glb(), "/images/0/uri"), ErrorCode::missing_buffer);
  Builder dangling = textured("");
  dangling.json["textures"][0]["source"] = 9;
  EXPECT_EQ(refusal(dangling.glb(), "/images/9"), ErrorCode::malformed_gltf);
  EXPECT_EQ(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "/textures"),
            ErrorCode::invalid_option);
  for (const std::string& file : {basisu.glb(), beside.glb(), dangling.glb()})
    EXPECT_NO_THROW(read_file(file, {.texcoord = TexcoordChoice::automatic}));
}

}  // namespace
}  // namespace unwrapd::asset::test
