// Layouts whose pictures are known beforehand.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "tests/core/texture/pictures.hpp"

namespace unwrapd::texture::test {
namespace {

constexpr Sampling kClamped = {Wrap::clamp, Wrap::clamp, false};

TEST(Resample, TheSameLayoutGivesTheSamePicture) {
  const Image image = noise(37, 37);
  const auto same = [](float u, float v) { return Eigen::Vector2f(u, v); };
  for (const Content content : {Content::colour, Content::values})
    EXPECT_EQ(paint(image, page(same), 37, content).image.rgba, image.rgba);
}

TEST(Resample, SixteenBitsStaySixteenBits) {
  const Image image = deep_noise(37, 37);
  const auto same = [](float u, float v) { return Eigen::Vector2f(u, v); };
  for (const Content content : {Content::colour, Content::values})
    EXPECT_EQ(paint(image, page(same), 37, content).image.deep, image.deep);
  Painted half = paint(image, page([](float u, float v) { return Eigen::Vector2f(u, v / 2); }), 37);
  std::fill(half.is_covered.begin() + 37, half.is_covered.end(), std::uint8_t{0});
  dilate(half, {});
  for (int x = 0; x < 37; ++x)
    EXPECT_EQ(half.image.deep[half.image.index(x, 36)], half.image.deep[half.image.index(x, 0)]);
}

TEST(Resample, ALayoutTurnedByNinetyDegreesGivesTheTurnedPicture) {
  const Image image = noise(16, 16);
  const auto turned = [](float u, float v) { return Eigen::Vector2f(v, 1 - u); };
  const Image result = paint(image, page(turned), 16).image;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) EXPECT_EQ(at(result, x, y), at(image, y, 15 - x));
}

TEST(Resample, APageNeedNotBeSquare) {
  const Image image = noise(24, 80);
  const auto same = [](float u, float v) { return Eigen::Vector2f(u, v); };
  EXPECT_EQ(paint(image, page(same), {24, 80}).image.rgba, image.rgba);
  const auto turned = [](float u, float v) { return Eigen::Vector2f(v, 1 - u); };
  const Image result = paint(image, page(turned), {80, 24}).image;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 80; ++x) EXPECT_EQ(at(result, x, y), at(image, y, 79 - x));
}

TEST(Resample, AMirroredLayoutGivesTheMirroredPicture) {
  const Image image = noise(16, 16);
  const auto mirrored = [](float u, float v) { return Eigen::Vector2f(1 - u, v); };
  const Image result = paint(image, page(mirrored), 16).image;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) EXPECT_EQ(at(result, x, y), at(image, 15 - x, y));
}

TEST(Resample, EachWrapReadsBeyondTheImageAsASamplerDoes) {
  const Image image = noise(8, 8);
  const auto shifted = [](float u, float v) { return Eigen::Vector2f(u + 1.25F, v - 2); };
  const Image repeated = paint(image, page(shifted, {Wrap::repeat, Wrap::repeat, false}), 8).image;
  const Image mirrored = paint(image, page(shifted, {Wrap::mirror, Wrap::repeat, false}), 8).image;
  const Image clamped = paint(image, page(shifted, {Wrap::clamp, Wrap::repeat, false}), 8).image;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const int column = x + 10;  // of 8
      EXPECT_EQ(at(repeated, x, y), at(image, column % 8, y));
      EXPECT_EQ(at(mirrored, x, y), at(image, column < 16 ? 15 - column : column - 16, y));
      EXPECT_EQ(at(clamped, x, y), at(image, 7, y));
    }
}

TEST(Resample, ALinearSamplerMixesNeighboursAndANearestOneDoesNot) {
  const Image image = picture(2, 1, [](int x, int) { return Rgba{x * 200, 0, 0, 255}; });
  const auto middle = [](float u, float v) { return Eigen::Vector2f(0.25F + u / 2, v); };
  const Image linear = paint(image, page(middle, kClamped), 4, Content::values).image;
  const Image nearest =
      paint(image, page(middle, {Wrap::clamp, Wrap::clamp, true}), 4, Content::values).image;
  for (int x = 0; x < 4; ++x) {
    EXPECT_NEAR(at(linear, x, 0)[0], 200 * (x + 0.5) / 4, 1);
    EXPECT_EQ(at(nearest, x, 0)[0], x < 2 ? 0 : 200);
  }
}

TEST(Resample, MinifiedColoursAreAveragedInLinearLight) {
  const Image checker = picture(64, 64, [](int x, int y) {
    return (x + y) % 2 == 0 ? Rgba{255, 255, 255, 255} : Rgba{0, 0, 0, 255};
  });
  const auto same = [](float u, float v) { return Eigen::Vector2f(u, v); };
  for (const int side : {16, 4, 1}) {  // 4, 16 and 64 texels under one: samples, then mip levels
    EXPECT_NEAR(at(paint(checker, page(same), side).image, 0, 0)[0], 188, 1);  // half the light
    EXPECT_NEAR(at(paint(checker, page(same), side, Content::values).image, 0, 0)[0], 128, 1);
  }
}

TEST(Resample, ATexelIsTheMeanOfAllThatLiesUnderIt) {
  const Image image = noise(64, 64);
  const auto same = [](float u, float v) { return Eigen::Vector2f(u, v); };
  for (const int side : {32, 16, 8, 4, 2, 1}) {
    const Image small = paint(image, page(same, kClamped), side, Content::values).image;
    const int under = 64 / side;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        double sum = 0;
        for (int j = 0; j < under; ++j)
          for (int i = 0; i < under; ++i) sum += at(image, x * under + i, y * under + j)[0];
        EXPECT_NEAR(at(small, x, y)[0], sum / (under * under), 1) << side;
      }
  }
}

TEST(Resample, TheLastColumnOfAnOddWidthCounts) {
  const Image image = picture(63, 64, [](int x, int) {
    return x == 62 ? Rgba{255, 255, 255, 255} : Rgba{0, 0, 0, 255};
  });
  const Texture texture(image, false, {});
  EXPECT_NEAR(texture.sample({0.999, 0.5}, 1, kClamped)[0], 1.0 / 3, 0.01);  // of three columns
}

TEST(Resample, AnElongatedFootprintIsAveragedAlongItsLengthOnly) {
  const Image stripes = picture(64, 64, [](int x, int y) {
    return Rgba{x % 2 * 255, y < 32 ? 0 : 255, 0, 255};
  });
  const auto squeezed = [](float u, float v) { return Eigen::Vector2f(u, v); };
  Patch patch = page(squeezed, kClamped);
  for (PlacedTriangle& triangle : patch.triangles)
    for (Eigen::Vector2f& to : triangle.to) to.x() /= 8;
  const Image result = paint(stripes, patch, 64, Content::values).image;
  for (int y = 0; y < 64; ++y) {
    EXPECT_NEAR(at(result, 3, y)[0], 128, 1);
    EXPECT_NEAR(at(result, 3, y)[1], y < 32 ? 0 : 255, 1) << y;
  }
}

TEST(Resample, TrianglesOfOnePageMeetWithoutGaps) {
  Patch fan{kClamped, {}, {}};
  const Eigen::Vector2f center(40.5F / 128, 74.5F / 128);  // where a sample is
  const auto rim = [](int k) {
    const float angle = 6.2831853F * static_cast<float>(k % 97) / 97;
    return Eigen::Vector2f(0.5F + 2 * std::cos(angle), 0.5F + 2 * std::sin(angle));
  };
  for (int k = 0; k < 97; ++k) {
    std::array<Eigen::Vector2f, 3> place = {center, rim(k), rim(k + 1)};
    std::rotate(place.begin(), place.begin() + k % 3, place.end());
    fan.triangles.push_back({place, place});
  }
  const Painted painted = paint(noise(16, 16), fan, 128);
  EXPECT_EQ(std::count(painted.is_covered.begin(), painted.is_covered.end(), 0), 0);
}

TEST(Resample, WhatLiesOutsideThePageOrHasNoAreaIsLeftOut) {
  Patch patch{kClamped, {}, {}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  patch.triangles.push_back({{}, {{{2, 2}, {3, 2}, {2, 3}}}});
  patch.triangles.push_back({{}, {{{0.1F, 0.1F}, {0.5F, 0.5F}, {0.9F, 0.9F}}}});
  patch.triangles.push_back({{}, {{{nan, 0}, {1, 0}, {0, 1}}}});
  patch.triangles.push_back({{{{nan, 0}, {1, 0}, {0, 1}}}, {{{0, 0}, {1, 0}, {0, 1}}}});
  const Painted painted = paint(noise(4, 4), patch, 16);
  EXPECT_EQ(std::count(painted.is_covered.begin(), painted.is_covered.end(), 1), 0);
}

TEST(Resample, EndsWhenItIsStopped) {
  std::stop_source source;
  source.request_stop();
  const auto same = [](float u, float v) { return Eigen::Vector2f(u, v); };
  EXPECT_THROW(resample(Texture(noise(4, 4), true, {}), std::array{page(same)}, {64, 64},
                        Content::colour, source.get_token()),
               Error);
}

TEST(Dilate, GivesEveryTexelTheColourOfANearestCoveredOne) {
  Painted painted{picture(40, 50, [](int x, int y) { return Rgba{x, y, 0, 255}; }), {}};
  painted.is_covered.assign(2000, 0);
  const std::array<std::array<int, 2>, 4> islands = {{{3, 4}, {30, 7}, {12, 33}, {39, 49}}};
  for (const auto& [x, y] : islands) painted.is_covered[static_cast<std::size_t>(40 * y + x)] = 1;
  dilate(painted, {});
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 40; ++x) {
      double nearest = 1e9;
      for (const auto& [ix, iy] : islands) nearest = std::min(nearest, std::hypot(x - ix, y - iy));
      const Rgba source = at(painted.image, x, y);
      EXPECT_LE(std::hypot(x - source[0], y - source[1]), nearest + 0.5);
    }
}

TEST(Dilate, LeavesAnEmptyPageAsItIs) {
  Painted painted{picture(4, 4, [](int, int) { return Rgba{7, 7, 7, 7}; }), {}};
  painted.is_covered.assign(16, 0);
  dilate(painted, {});
  EXPECT_EQ(at(painted.image, 3, 3), (Rgba{7, 7, 7, 7}));
}

TEST(Detail, AScaleKeepsTheTexelsOfTheImage) {
  const auto part = [](float u, float v) { return Eigen::Vector2f(u / 2, v / 4); };
  EXPECT_DOUBLE_EQ(scale_that_keeps_detail(std::array{page(part)}, {1, 1}, {1024, 512}, {}), 512);
  EXPECT_DOUBLE_EQ(scale_that_keeps_detail(std::array{page(part)}, {2, 1}, {1024, 512}, {}), 256);
  const auto tiled = [](float u, float v) { return Eigen::Vector2f(3 * u, v); };
  EXPECT_DOUBLE_EQ(scale_that_keeps_detail(std::array{page(tiled)}, {1, 1}, {256, 256}, {}), 768);
  const auto point = [](float, float) { return Eigen::Vector2f(0.5F, 0.5F); };
  EXPECT_EQ(scale_that_keeps_detail(std::array{page(point)}, {1, 1}, {256, 256}, {}), 0);
}

TEST(Detail, ATwentiethOfTheImageMayLoseSome) {
  const auto strips = [](float squeezed) {  // the rest of the image is on the rest of the page
    const auto strip = [](float from, float to, float low, float high) {
      Patch patch =
          page([&](float u, float v) { return Eigen::Vector2f(from + u * (to - from), v); });
      for (PlacedTriangle& triangle : patch.triangles)
        for (Eigen::Vector2f& corner : triangle.to) corner.x() = low + corner.x() * (high - low);
      return patch;
    };
    return std::array{strip(0, 1 - squeezed, 0, 1 - squeezed),
                      strip(1 - squeezed, 1, 1 - squeezed, 1 - squeezed / 2)};
  };
  EXPECT_NEAR(scale_that_keeps_detail(strips(0.04F), {1, 1}, {256, 256}, {}), 256, 1);
  EXPECT_NEAR(scale_that_keeps_detail(strips(0.06F), {1, 1}, {256, 256}, {}), 512, 1);
}

}  // namespace
}  // namespace unwrapd::texture::test
