// The scales: ends and middles, what each colouring shows, colours in order.
#include "core/figure/colour_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace unwrapd::figure {
namespace {

constexpr std::array kEveryColouring = {Colouring::stretch, Colouring::angle, Colouring::area,
                                        Colouring::flips};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The Jacobian diag(a, d).
measure::Jacobian diagonal(double a, double d) { return {(a + d) / 2, 0, (a - d) / 2, 0}; }

/// Relative luminance (WCAG 2).
double luminance(const Rgb& colour) {
  const auto linear = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(colour[0] / 255.0) + 0.7152 * linear(colour[1] / 255.0) +
         0.0722 * linear(colour[2] / 255.0);
}

TEST(ColourScale, NamesAndColouringsAnswerEachOther) {
  for (const Colouring colouring : kEveryColouring) {
    const std::string_view name = kColouringNames[static_cast<std::size_t>(colouring)];
    EXPECT_EQ(colouring_named(name), colouring);
    EXPECT_EQ(colour_scale(colouring).title, name);
  }
  EXPECT_FALSE(colouring_named("color"));
}

TEST(ColourScale, WhatOnlyGetsWorseGoesFromTheFirstColourToTheLast) {
  for (const Colouring colouring : {Colouring::stretch, Colouring::angle}) {
    const ColourScale& scale = colour_scale(colouring);
    EXPECT_EQ(scale.position(1), 0);
    EXPECT_NEAR(scale.position(2), 5.5, 1e-12);
    EXPECT_NEAR(scale.position(4), 11, 1e-12);
    EXPECT_EQ(scale.colour_of(3.99), 10);
    EXPECT_EQ(scale.colour_of(4.01), 11);
    EXPECT_EQ(scale.colour_of(0.5), 0);
    EXPECT_EQ(scale.colour_of(kInfinity), 11);
    EXPECT_EQ(scale.colour_of(std::nan("")), 11);
  }
}

TEST(ColourScale, AreasThatAreRightLieInTheMiddleOfBothWays) {
  const ColourScale& scale = colour_scale(Colouring::area);
  EXPECT_NEAR(scale.position(1), 6.5, 1e-12);
  EXPECT_EQ(scale.colour_of(1), 6);
  EXPECT_EQ(scale.colour_of(0.24), 0);
  EXPECT_EQ(scale.colour_of(0), 0);
  EXPECT_EQ(scale.colour_of(4.1), 12);
  EXPECT_EQ(scale.colour_of(kInfinity), 12);
  for (double ratio = 1.05; ratio < 8; ratio *= 1.1)
    EXPECT_EQ(scale.colour_of(ratio) + scale.colour_of(1 / ratio), 12) << ratio;
}

TEST(ColourScale, GreyPicturesKeepTheOrder) {
  const auto stretch = colour_scale(Colouring::stretch).colours;
  for (std::size_t k = 1; k < stretch.size(); ++k)
    EXPECT_LT(luminance(stretch[k]), luminance(stretch[k - 1]));
  const auto area = colour_scale(Colouring::area).colours;
  for (std::size_t k = 1; k < area.size(); ++k)
    EXPECT_EQ(luminance(area[k]) > luminance(area[k - 1]), k <= 6) << k;
}

TEST(ColourScale, EveryTickLiesOnItsBar) {
  for (const Colouring colouring : kEveryColouring) {
    const ColourScale& scale = colour_scale(colouring);
    ASSERT_FALSE(scale.ticks.empty());
    EXPECT_FALSE(scale.caption.empty());
    for (const Tick& tick : scale.ticks) {
      EXPECT_GE(scale.position(tick.value), 0);
      EXPECT_LE(scale.position(tick.value), static_cast<double>(scale.colours.size()) - 1);
    }
  }
}

TEST(ColourScale, FiguresAreThoseOfTheSingularValues) {
  const measure::Jacobian j = diagonal(6, 0.5);
  EXPECT_NEAR(shown_value(Colouring::angle, j, 3), 12, 1e-12);
  EXPECT_NEAR(shown_value(Colouring::area, j, 0.5), 0.75, 1e-12);
  EXPECT_NEAR(shown_value(Colouring::stretch, j, 0.5), 4, 1e-12);  // 1 / (0.5 * 0.5)
  EXPECT_NEAR(shown_value(Colouring::stretch, j, 2), 12, 1e-12);   // 2 * 6
  EXPECT_EQ(shown_value(Colouring::flips, j, 2), 1);
}

TEST(ColourScale, AnImageWithoutAreaIsWorstAndNoTrap) {
  for (const measure::Jacobian& j : {diagonal(0, 0), diagonal(1, 0)}) {
    EXPECT_EQ(colour_scale(Colouring::angle).colour_of(shown_value(Colouring::angle, j, 1)), 11);
    EXPECT_EQ(colour_scale(Colouring::stretch).colour_of(shown_value(Colouring::stretch, j, 1)),
              11);
    EXPECT_EQ(colour_scale(Colouring::area).colour_of(shown_value(Colouring::area, j, 1)), 0);
  }
}

TEST(ColourScale, ColoursAreWrittenInHexadecimal) {
  EXPECT_EQ(hex({0x00, 0x0f, 0xa9}), "#000fa9");
  EXPECT_EQ(hex(kFlippedColour), "#ff2a4d");
}

}  // namespace
}  // namespace unwrapd::figure
