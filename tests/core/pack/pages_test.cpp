// Islands at a given density, on several pages, and on top of each other.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.hpp"
#include "core/pack/pack.hpp"
#include "tests/core/outlines.hpp"

namespace unwrapd::pack {
namespace {

using shapes::pack_alone;
using shapes::polygon;
using shapes::square;

/// A corner cut off, so that no turn maps it onto itself; moved, and turned by an angle.
charts::Outline flag(double size, double angle, const Vec2& at) {
  UvMap points{{0, 0}, {3, 0}, {3, 1}, {1, 1.5}, {1, 2}, {0, 2}};
  for (Vec2& p : points)
    p = at + size * Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                         std::sin(angle) * p.x() + std::cos(angle) * p.y());
  return polygon(points);
}

int page_of(const charts::Outline& island, const Placement& placement) {
  return static_cast<int>(std::floor(placement(island.front()[0]).x()));
}

TEST(Pages, EveryIslandHasTheDensityThatIsAskedFor) {
  const std::vector<charts::Outline> islands{square(1), square(2), flag(1, 0.3, {7, 7})};
  const PackResult packed = pack_alone(
      islands, {.resolution = 1024, .padding = 4, .packing = {.texels_per_unit = 100.0}});
  EXPECT_EQ(packed.pages, 1);
  for (const Placement& placement : packed.placements)
    EXPECT_NEAR(placement.scale * 1024, 100, 1e-9);
}

TEST(Pages, WhatDoesNotFitOnOnePageGoesToTheNextAndNeverAcrossTheBorder) {
  const std::vector<charts::Outline> islands(7, square(1));
  const PageOptions page{
      .resolution = 256, .padding = 2, .packing = {.texels_per_unit = 100.0, .max_pages = 4}};
  const PackResult packed = pack_alone(islands, page);
  EXPECT_EQ(packed.pages, 2);  // four squares of 100 texels on a page of 256
  for (std::size_t k = 0; k < islands.size(); ++k) {
    const int own = page_of(islands[k], packed.placements[k]);
    for (const auto& [a, b] : islands[k]) {
      const Vec2 p = packed.placements[k](a) - Vec2(own, 0);
      EXPECT_GE(p.minCoeff(), 2 / 256.0 - 1e-12);
      EXPECT_LE(p.maxCoeff(), 1 - 2 / 256.0 + 1e-12);
    }
  }
}

TEST(Pages, SaysClearlyThatADensityDoesNotFit) {
  const auto code_of = [](const std::vector<charts::Outline>& islands, const Packing& packing) {
    try {
      pack_alone(islands, {.resolution = 256, .padding = 2, .packing = packing});
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), "/texels_per_unit");
      return error.code();
    }
    return ErrorCode::internal;
  };
  const std::vector<charts::Outline> seven(7, square(1)), large{square(3)};
  EXPECT_EQ(code_of(seven, {.texels_per_unit = 100.0}), ErrorCode::does_not_fit);
  EXPECT_EQ(code_of(large, {.texels_per_unit = 100.0, .max_pages = 10}), ErrorCode::does_not_fit);
}

TEST(Pages, MorePagesGiveMoreTexels) {
  std::vector<charts::Outline> islands;
  for (int k = 0; k < 20; ++k) islands.push_back(flag(1 + 0.03 * k, 0.1 * k, {0, 0}));
  const PackResult one = pack_alone(islands, {}),
                   four = pack_alone(islands, {.packing = {.max_pages = 4}});
  EXPECT_EQ(one.pages, 1);
  EXPECT_EQ(four.pages, 4);
  EXPECT_GT(four.placements[0].scale, 1.7 * one.placements[0].scale);  // 2 is all
}

TEST(CongruentIslands, IslandsOfOneShapeShareAPlaceWhateverWayTheyLie) {
  std::vector<charts::Outline> islands;
  for (int k = 0; k < 6; ++k) islands.push_back(flag(1, 0.7 * k, {5.0 * k, -k}));
  islands.push_back(square(2));
  const PageOptions page{.packing = {.stack_identical = true}};
  const PackResult packed = pack_alone(islands, page);
  EXPECT_EQ(packed.is_stacked, (std::vector<char>{0, 1, 1, 1, 1, 1, 0}));
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t i = 0; i < islands[k].size(); ++i)
      EXPECT_LT(
          (packed.placements[k](islands[k][i][0]) - packed.placements[0](islands[0][i][0])).norm(),
          1e-9);
  EXPECT_GT(packed.placements[0].scale, 1.5 * pack_alone(islands, {}).placements[0].scale);
}

TEST(CongruentIslands, MirrorImagesAndOtherSizesAreOtherShapes) {
  charts::Outline mirrored = flag(1, 0, {0, 0});
  for (auto& segment : mirrored) {
    for (Vec2& p : segment) p.x() = -p.x();
    std::swap(segment[0], segment[1]);
  }
  std::reverse(mirrored.begin(), mirrored.end());
  const std::vector<charts::Outline> islands{flag(1, 0, {0, 0}), mirrored, flag(1.01, 0, {0, 0})};
  const PackResult packed = pack_alone(islands, {.packing = {.stack_identical = true}});
  EXPECT_EQ(packed.is_stacked, (std::vector<char>{0, 0, 0}));
}

TEST(Pages, ThousandsOfIslandsAreStoppedAtOnce) {
  std::stop_source stop;
  stop.request_stop();
  const std::vector<charts::Outline> islands(3000, square(1));
  try {
    pack_alone(islands, {}, stop.get_token());
    ADD_FAILURE() << "it went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace unwrapd::pack
