// How far islands may be turned, and that they then lie along the page.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/pack/box.hpp"
#include "core/pack/pack.hpp"
#include "tests/core/outlines.hpp"

namespace unwrapd::pack {
namespace {

using shapes::net;
using shapes::pack_alone;
using shapes::polygon;

charts::Outline rectangle(double width, double height, double angle) {
  UvMap points{{0, 0}, {width, 0}, {width, height}, {0, height}};
  for (Vec2& p : points)
    p = Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y() + 3,
             std::sin(angle) * p.x() + std::cos(angle) * p.y() - 7);
  return polygon(points);
}

std::vector<charts::Outline> turned_rectangles(int count) {
  std::vector<charts::Outline> islands;
  for (int k = 0; k < count; ++k)
    islands.push_back(rectangle(1 + 0.1 * (k % 7), 0.4 + 0.2 * (k % 5), 0.37 * k + 0.1));
  return islands;
}

/// Nets of boxes, whose smallest rectangles lie aslant.
std::vector<charts::Outline> turned_nets(int count) {
  std::vector<charts::Outline> islands;
  for (int k = 0; k < count; ++k) islands.push_back(net(1 + 0.1 * (k % 3), 0.6, 0.53 * k + 0.2));
  return islands;
}

/// The greatest angle between a side of a placed island and the nearest axis.
double most_aslant(const std::vector<charts::Outline>& islands, const PackResult& packed) {
  double most = 0;
  for (std::size_t k = 0; k < islands.size(); ++k)
    for (const auto& [a, b] : islands[k]) {
      const Vec2 side = (packed.placements[k](b) - packed.placements[k](a)).cwiseAbs();
      most = std::max(most, std::atan2(side.minCoeff(), side.maxCoeff()));
    }
  return most;
}

PackResult turned_by(const std::vector<charts::Outline>& islands, Rotation rotation,
                     Packing packing = {}) {
  packing.rotation = rotation;
  return pack_alone(islands, {.packing = packing});
}

/// Whether no corner of one island lies in another, nor nearer to its sides than the padding.
void expect_apart(const std::vector<charts::Outline>& islands, const PackResult& packed) {
  const double least = packed.padding / 1024 - 1e-9;
  for (std::size_t i = 0; i < islands.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE(shapes::gap(shapes::placed(islands[i], packed.placements[i]),
                            shapes::placed(islands[j], packed.placements[j])),
                least)
          << i << " and " << j;
}

// One island, few (compacted), many (touching perimeter).
class IslandCounts : public testing::TestWithParam<int> {};

TEST_P(IslandCounts, WithQuarterTurnsRightAnglesLieAlongThePage) {
  const std::vector<charts::Outline> rectangles = turned_rectangles(GetParam()),
                                     nets = turned_nets(GetParam());
  for (const auto& islands : {rectangles, nets}) {
    const PackResult packed = turned_by(islands, Rotation::quarter);
    EXPECT_LT(most_aslant(islands, packed), 1e-9);
    expect_apart(islands, packed);
  }
}

TEST_P(IslandCounts, WithoutRotationEveryIslandKeepsItsAngle) {
  const std::vector<charts::Outline> islands = turned_rectangles(GetParam());
  const PackResult packed = turned_by(islands, Rotation::none);
  for (const Placement& placement : packed.placements) {
    EXPECT_EQ(placement.cosine, 1);
    EXPECT_EQ(placement.sine, 0);
  }
  expect_apart(islands, packed);
}

INSTANTIATE_TEST_SUITE_P(Pack, IslandCounts, testing::Values(1, 2, 9, 60));

TEST(Rotation, HoldsOnSeveralPagesAndAtAGivenDensity) {
  const std::vector<charts::Outline> islands = turned_nets(12);
  for (const Packing& packing : {Packing{.max_pages = 3}, Packing{.texels_per_unit = 60.0}}) {
    EXPECT_LT(most_aslant(islands, turned_by(islands, Rotation::quarter, packing)), 1e-9);
    for (const Placement& placement : turned_by(islands, Rotation::none, packing).placements)
      EXPECT_EQ(placement.sine, 0);
  }
}

TEST(Rotation, WithoutOneARectangleThatLiesAcrossThePageStaysAcrossIt) {
  const double side = 1 - 4.0 / 1024;  // two texels at either end
  for (const Vec2& size : {Vec2(4, 1), Vec2(1, 4)}) {
    const std::vector<charts::Outline> islands{rectangle(size.x(), size.y(), 0)};
    const PackResult packed = turned_by(islands, Rotation::none);
    Vec2 low = Vec2::Constant(2), high = -low;
    for (const auto& [a, b] : islands[0]) {
      low = low.cwiseMin(packed.placements[0](a));
      high = high.cwiseMax(packed.placements[0](a));
    }
    EXPECT_LT((high - low - side / 4 * size).norm(), 1e-6);
  }
}

TEST(Rotation, WithoutOneOnlyIslandsThatLieAlikeAreStacked) {
  std::vector<charts::Outline> islands{net(1, 0.6, 0.3), net(1, 0.6, 0.3), net(1, 0.6, 1.3)};
  for (auto& [a, b] : islands[1]) a += Vec2(5, 5), b += Vec2(5, 5);
  const Packing stacked{.stack_identical = true};
  const auto stacked_count = [&](const PackResult& packed) {
    return std::ranges::count(packed.is_stacked, 1);
  };
  EXPECT_EQ(stacked_count(turned_by(islands, Rotation::any, stacked)), 2);
  const PackResult packed = turned_by(islands, Rotation::none, stacked);
  EXPECT_EQ(stacked_count(packed), 1);
  EXPECT_EQ(packed.is_stacked[2], 0);
  for (const Placement& placement : packed.placements) EXPECT_EQ(placement.sine, 0);
}

TEST(Rotation, ARectangleFillsThePageBestWhereItMayTurn) {
  const std::vector<charts::Outline> islands{rectangle(1, 1, 0.7)};
  const double any = turned_by(islands, Rotation::any).placements[0].scale;
  EXPECT_NEAR(turned_by(islands, Rotation::quarter).placements[0].scale, any, 1e-6);
  const double slanted = std::cos(0.7) + std::sin(0.7);  // the width of the turned unit square
  EXPECT_NEAR(turned_by(islands, Rotation::none).placements[0].scale * slanted, any, 1e-6);
}

}  // namespace
}  // namespace unwrapd::pack
