// Flat pictures: what is on top, how borders blend, lines and letters.
#include "core/figure/raster.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/figure/lettering.hpp"

namespace unwrapd::figure {
namespace {

constexpr Rgb kWhite = {255, 255, 255}, kBlack = {0, 0, 0}, kRed = {200, 0, 0};

/// The share of ink in a picture of black on white, in pixels.
double ink(const Image& image) {
  double sum = 0;
  for (const std::uint8_t part : image.rgb) sum += 1 - part / 255.0;
  return sum / 3;
}

TEST(Raster, APixelIsTheMeanOfWhatCoversIt) {
  std::vector<FlatTriangle> drawing;
  append_rectangle(drawing, {2, 3}, {10.5, 8}, kBlack);
  const Image image = rasterised(drawing, {20, 37, kWhite});
  EXPECT_EQ(image.rgb.size(), 3U * 20 * 37);
  EXPECT_EQ(image.at(1, 4), kWhite);
  EXPECT_EQ(image.at(2, 3), kBlack);
  EXPECT_EQ(image.at(10, 7), (Rgb{128, 128, 128}));
  EXPECT_EQ(image.at(11, 7), kWhite);
  EXPECT_EQ(image.at(5, 8), kWhite);
  EXPECT_NEAR(ink(image), 8.5 * 5, 0.1);
}

TEST(Raster, TheLaterCoversTheEarlierInEveryBand) {
  std::vector<FlatTriangle> drawing;
  append_rectangle(drawing, {0, 0}, {50, 50}, kBlack);
  append_rectangle(drawing, {10, 10}, {40, 45}, kRed);
  const Image image = rasterised(drawing, {50, 50, kWhite});
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 50; ++x) {
      const bool inside = x >= 10 && x < 40 && y >= 10 && y < 45;
      ASSERT_EQ(image.at(x, y), inside ? kRed : kBlack) << x << " " << y;
    }
}

TEST(Raster, ALineHasItsWidthWhereverItLeads) {
  for (int k = 0; k < 12; ++k) {
    const double turn = k * std::numbers::pi / 6 + 0.1;
    const Vec2 along(std::cos(turn), std::sin(turn)), middle(50, 50);
    std::vector<FlatTriangle> drawing;
    append_line(drawing, {middle - 30 * along, middle + 30 * along}, 4, kBlack);
    const Image image = rasterised(drawing, {100, 100, kWhite});
    const double both_ends = 8 * 2 * 2 * std::tan(std::numbers::pi / 8);  // an octagon's area
    EXPECT_NEAR(ink(image), 60 * 4 + both_ends, 2.5) << turn;
    EXPECT_EQ(image.at(50, 50), kBlack);
  }
}

TEST(Raster, ALineWithoutLengthIsADot) {
  std::vector<FlatTriangle> drawing;
  append_line(drawing, {Vec2(8, 8), Vec2(8, 8)}, 4, kBlack);
  EXPECT_NEAR(ink(rasterised(drawing, {16, 16, kWhite})), 13.25, 0.7);
}

TEST(Raster, EveryLetterAndDigitIsDrawnAndNoTwoAlike) {
  const std::string known = "abcdefghijklmnopqrstuvwxyz0123456789/.";
  std::vector<Image> seen;
  for (const char letter : known) {
    std::vector<FlatTriangle> drawing;
    append_text(drawing, std::string(1, letter), {4, 20}, 24);
    seen.push_back(rasterised(drawing, {32, 32, kWhite}));
    EXPECT_GT(ink(seen.back()), 2) << letter;
    for (std::size_t k = 0; k + 1 < seen.size(); ++k)
      EXPECT_NE(seen[k].rgb, seen.back().rgb) << letter << known[k];
  }
}

TEST(Raster, TextStaysWithinItsWidthAndItsLine) {
  const std::string text = "4 or more";
  const double width = text_width(text, 20);
  std::vector<FlatTriangle> drawing;
  append_text(drawing, text, {10, 30}, 20);
  const Image image = rasterised(drawing, {120, 48, kWhite});
  double outside = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 120; ++x)
      if (x < 8 || x > 12 + width || y < 13 || y > 31) outside += 255 - image.at(x, y)[0];
  EXPECT_EQ(outside, 0);
  EXPECT_GT(ink(image), 40);
  EXPECT_EQ(text_width("", 20), 0);
}

TEST(Raster, WhatIsUnknownIsLeftBlank) {
  std::vector<FlatTriangle> drawing;
  append_text(drawing, " \x7f~", {4, 20}, 24);
  EXPECT_TRUE(drawing.empty());
}

}  // namespace
}  // namespace unwrapd::figure
