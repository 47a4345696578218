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

}  // namespace
}  // namespace unwrapd::server::routes
