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
        R"("guarantee":"bijective","constraints":[{"vertex":0,"uv":[0,0]}])"}) {
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

TEST(TexturesOption, PaintsAtLeastAtTheSizeOfThePage) {
  const auto page = [](const std::string& members) {
    const PageSize size = parse_options_text(with(members), kDefaultLimits).asset.page;
    return std::array{size.width, size.height};
  };
  EXPECT_EQ(page(R"("resolution":512)"), (std::array{512, 512}));
  EXPECT_EQ(page(R"("width":512,"height":2048)"), (std::array{512, 2048}));
  EXPECT_EQ(page(R"("height":2048)"), (std::array{1024, 2048}));
}

}  // namespace
}  // namespace unwrapd::api
