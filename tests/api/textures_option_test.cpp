// textures=transfer: what it goes with.
#include <gtest/gtest.h>

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

const Limits kDefaultLimits;

std::string with(const std::string& members) {
  return R"({"textures":"transfer")" + (members.empty() ? "" : "," + members) + "}";
}

TEST(TexturesOption, IsKeepUnlessItIsAskedFor) {
  for (const Preset preset : {Preset::texture, Preset::lightmap, Preset::chart, Preset::paper})
    EXPECT_EQ(preset_options(preset).asset.textures, TextureMode::keep);
  EXPECT_EQ(parse_options_text(with(""), kDefaultLimits).asset.textures, TextureMode::transfer);
}

TEST(TexturesOption, NeedsAPlaceOfItsOwnForEveryTexel) {
  for (const std::string members :
       {R"("guarantee":"flip_free")", R"("preset":"chart")", R"("max_pages":2)",
        R"("stack_identical":true)", R"("boundary":"circle")", R"("group":"material")",
        R"("guarantee":"bijective","constraints":[{"vertex":0,"uv":[0,0]}])", R"("height":512)"}) {
    SCOPED_TRACE(members);
    try {
      parse_options_text(with(members), kDefaultLimits);
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_option);
      EXPECT_EQ(error.where(), "/textures");
    }
  }
  for (const std::string members :
       {R"("repack_only":true)", R"("preset":"chart","guarantee":"bijective")",
        R"("boundary":"circle","guarantee":"bijective")"})
    EXPECT_NO_THROW(parse_options_text(with(members), kDefaultLimits)) << members;
}

TEST(TexturesOption, PaintsAtLeastAtTheResolutionOfThePage) {
  for (const char* members : {R"("resolution":512)", R"("width":512,"height":512)"})
    EXPECT_EQ(parse_options_text(with(members), kDefaultLimits).asset.resolution, 512) << members;
}

}  // namespace
}  // namespace unwrapd::api
