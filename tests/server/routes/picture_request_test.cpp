// What a query asks of a picture, and the file that a picture becomes.
#include <gmock/gmock.h>

#include "server/routes/picture_routes.hpp"
#include "server/work/png_file.hpp"
#include "tests/server/decode_png.hpp"

namespace unwrapd::server::routes {
namespace {

using testing::StartsWith;

TEST(PngFile, GivesBackThePictureItWasGiven) {
  figure::Image image{.width = 37, .height = 5, .rgb = {}};
  for (int k = 0; k < 3 * 37 * 5; ++k) image.rgb.push_back(static_cast<std::uint8_t>(k * k));
  const std::string bytes = work::encode_png(image);
  EXPECT_THAT(bytes, StartsWith(kSignature));
  EXPECT_EQ(bytes, work::encode_png(image));
  const figure::Image read = decode_png(bytes);
  EXPECT_EQ(read.width, 37);
  EXPECT_EQ(read.height, 5);
  EXPECT_EQ(read.rgb, image.rgb);
}

TEST(PictureOf, TakesWhatThePictureHasAndNothingElse) {
  const work::Picture plain = picture_of(work::PictureKind::layout_png, {});
  EXPECT_EQ(plain.colouring, figure::Colouring::stretch);
  EXPECT_EQ(plain.size, 1024);
  const work::Picture asked =
      picture_of(work::PictureKind::layout_png, {{"colour", "flips"}, {"size", "64"}});
  EXPECT_EQ(asked.colouring, figure::Colouring::flips);
  EXPECT_EQ(asked.size, 64);
  EXPECT_THROW(picture_of(work::PictureKind::layout_svg, {{"size", "64"}}), Error);
  EXPECT_THROW(picture_of(work::PictureKind::preview_png, {{"colour", "area"}}), Error);
}

using work::PictureKind;

work::Picture layout(const std::multimap<std::string, std::string>& query) {
  return picture_of(PictureKind::layout_png, query);
}

std::string refused_at(PictureKind kind, const std::multimap<std::string, std::string>& query) {
  try {
    picture_of(kind, query);
  } catch (const Error& error) {
    return error.where();
  }
  return "nowhere";
}

TEST(PngFile, GivesBackAlpha) {
  const figure::Image image{
      .width = 2, .height = 1, .rgb = {10, 20, 30, 40, 50, 60}, .alpha = {255, 0}};
  const figure::Image read = decode_png(work::encode_png(image));
  EXPECT_EQ(read.rgb, image.rgb);
  EXPECT_EQ(read.alpha, image.alpha);
  EXPECT_TRUE(
      decode_png(work::encode_png({.width = 1, .height = 1, .rgb = {1, 2, 3}})).alpha.empty());
}

TEST(PictureOf, TemplatesHaveNoLegendUnlessTheyAreColoured) {
  EXPECT_TRUE(layout({}).legend);
  EXPECT_FALSE(layout({{"wireframe", "1"}}).legend);
  EXPECT_FALSE(layout({{"page", "2"}}).legend);
  EXPECT_TRUE(layout({{"page", "2"}, {"legend", "1"}}).legend);
  EXPECT_EQ(layout({{"size", "page"}}).page, 1);
  EXPECT_TRUE(layout({{"size", "page"}}).has_page_size);
  EXPECT_EQ(layout({{"size", "page"}, {"page", "3"}}).page, 3);
  EXPECT_FALSE(layout({{"background", "none"}}).background);
  EXPECT_TRUE(layout({{"numbers", "1"}}).numbers);
  EXPECT_EQ(refused_at(PictureKind::layout_png, {{"wireframe", "1"}, {"legend", "1"}}), "/legend");
  EXPECT_EQ(refused_at(PictureKind::layout_png, {{"wireframe", "1"}, {"colour", "area"}}),
            "/colour");
  EXPECT_EQ(refused_at(PictureKind::layout_svg, {{"size", "page"}}), "/size");
  EXPECT_EQ(refused_at(PictureKind::preview_png, {{"size", "page"}}), "/size");
  EXPECT_EQ(refused_at(PictureKind::preview_png, {{"wireframe", "1"}}), "/wireframe");
  EXPECT_EQ(refused_at(PictureKind::layout_png, {{"view", "front"}}), "/view");
}

TEST(PictureOf, TellsUnknownAndRepeatedParametersByJsonPointers) {  // RFC 6901, 3
  EXPECT_EQ(refused_at(PictureKind::layout_png, {{"a/b~", "1"}}), "/a~1b~0");
  EXPECT_EQ(refused_at(PictureKind::layout_png, {{"page", "1"}, {"page", "2"}}), "/page");
}

TEST(PictureOf, AViewIsANameOrTwoAngles) {
  const auto view = [](const std::string& text) {
    return picture_of(PictureKind::preview_png, {{"view", text}});
  };
  EXPECT_FALSE(view("auto").aspect);
  EXPECT_TRUE(view("turntable").turns);
  ASSERT_TRUE(view("right").aspect);
  EXPECT_EQ(view("right").aspect->azimuth, 90);
  ASSERT_TRUE(view("30,-20.556").aspect);
  EXPECT_EQ(view("30,-20.556").aspect->azimuth, 30);
  EXPECT_EQ(view("30,-20.556").aspect->elevation, -20.56);
  for (const char* text : {"", "30", "30,", ",20", "361,0", "0,90.5", "inf,0", "nan,0", "30,20,10"})
    EXPECT_EQ(refused_at(PictureKind::preview_png, {{"view", text}}), "/view") << text;
}

}  // namespace
}  // namespace unwrapd::server::routes
