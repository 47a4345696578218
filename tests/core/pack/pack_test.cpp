#include "core/pack/pack.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/pack/box.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::pack {
namespace {

using Rng = std::mt19937;

double uniform(Rng& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

UvMap random_island(Rng& rng, int points) {
  const double angle = uniform(rng, 0, 7), length = std::exp(uniform(rng, -2, 2));
  UvMap island;
  for (int k = 0; k < points; ++k) {
    const Vec2 p(length * uniform(rng, -1, 1), uniform(rng, -1, 1));
    island.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y() + 5,
                        std::sin(angle) * p.x() + std::cos(angle) * p.y() - 3);
  }
  return island;
}

struct Extent {
  Vec2 low = Vec2::Constant(1e300), high = -low;
};

Extent extent_of(const UvMap& island, const Placement& placement) {
  Extent box;
  for (const Vec2& uv : island) {
    box.low = box.low.cwiseMin(placement(uv));
    box.high = box.high.cwiseMax(placement(uv));
  }
  return box;
}

double gap(const Extent& a, const Extent& b) {
  return std::max((a.low - b.high).maxCoeff(), (b.low - a.high).maxCoeff());
}

/// Every pair of islands, by brute force.
void expect_apart(const std::vector<UvMap>& islands, const PageOptions& page, double padding) {
  const std::vector<Placement> placements = pack_in_rows(islands, page);
  ASSERT_EQ(placements.size(), islands.size());
  std::vector<Extent> boxes;
  for (std::size_t k = 0; k < islands.size(); ++k)
    boxes.push_back(extent_of(islands[k], placements[k]));
  const double least = padding / page.resolution;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    EXPECT_EQ(placements[k].scale, placements[0].scale);
    EXPECT_NEAR(std::hypot(placements[k].cosine, placements[k].sine), 1, 1e-12);
    EXPECT_GE(boxes[k].low.minCoeff(), least - 1e-12);
    EXPECT_LE(boxes[k].high.maxCoeff(), 1 - least + 1e-12);
    for (std::size_t j = 0; j < k; ++j) {
      EXPECT_GT(gap(boxes[j], boxes[k]), 0);
      EXPECT_GE(gap(boxes[j], boxes[k]), least - 1e-12);
    }
  }
}

bool inside(const std::array<Vec2, 3>& triangle, const Vec2& p) {
  int left = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 e = triangle[(i + 1) % 3] - triangle[i], d = p - triangle[i];
    left += e.x() * d.y() - e.y() * d.x() > 0;
  }
  return left == 0 || left == 3;
}

TEST(SmallestBox, HoldsAllPointsAndIsNoLargerThanAtAnyAngle) {
  Rng rng(1);
  for (int k = 0; k < 60; ++k) {
    const UvMap island = random_island(rng, 2 + k % 40);
    const Box box = smallest_box(island);
    const Placement turned{.cosine = box.cosine, .sine = box.sine};
    const Extent extent = extent_of(island, turned);
    EXPECT_LT((extent.low - box.low).norm() + (extent.high - box.low - box.size).norm(), 1e-9);
    for (int step = 0; step < 90; ++step) {
      const double angle = step * shapes::kTurn / 180;
      const Extent other = extent_of(island, {.cosine = std::cos(angle), .sine = std::sin(angle)});
      EXPECT_LE(box.size.prod(), (other.high - other.low).prod() + 1e-9);
    }
  }
}

TEST(SmallestBox, OfATurnedRectangleIsTheRectangle) {
  for (double angle : {0.0, 0.3, 1.0, 2.5}) {
    UvMap island;
    for (const Vec2& p : {Vec2(0, 0), Vec2(4, 0), Vec2(4, 1), Vec2(0, 1), Vec2(2, 0.5)})
      island.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                          std::sin(angle) * p.x() + std::cos(angle) * p.y());
    EXPECT_NEAR(smallest_box(island).size.prod(), 4, 1e-12);
    EXPECT_EQ(convex_hull(island).size(), 4U);
  }
}

TEST(SmallestBox, PointsOnALineAndASinglePointHaveNoArea) {
  EXPECT_EQ(smallest_box(UvMap{{2, 3}}).size, Vec2(0, 0));
  EXPECT_EQ(smallest_box(UvMap{{2, 3}, {2, 3}, {2, 3}}).size, Vec2(0, 0));
  const Box line = smallest_box(UvMap{{0, 0}, {3, 4}, {1.5, 2}});
  EXPECT_NEAR(line.size.maxCoeff(), 5, 1e-12);
  EXPECT_NEAR(line.size.minCoeff(), 0, 1e-12);
}

TEST(Box, TurnedByAQuarterIsTheBoxOfTheTurnedPoints) {
  Rng rng(2);
  const UvMap island = random_island(rng, 9);
  const Box box = smallest_box(island).turned_by_quarter();
  const Extent extent = extent_of(island, {.cosine = box.cosine, .sine = box.sine});
  EXPECT_LT((extent.low - box.low).norm() + (extent.high - box.low - box.size).norm(), 1e-9);
}

TEST(Pack, IslandsKeepThePaddingFromEachOtherAndFromTheBorder) {
  Rng rng(3);
  for (int count : {1, 2, 3, 10, 300}) {
    std::vector<UvMap> islands;
    for (int k = 0; k < count; ++k) islands.push_back(random_island(rng, 3 + k % 12));
    expect_apart(islands, {.resolution = 1024, .padding = 2}, 2);
    expect_apart(islands, {.resolution = 512, .padding = 0}, 0);
    expect_apart(islands, {.resolution = 4096, .padding = 16}, 16);
  }
}

TEST(Pack, TrianglesOfDifferentIslandsDoNotOverlap) {
  Rng rng(4);
  std::vector<UvMap> islands;
  for (int k = 0; k < 50; ++k) islands.push_back(random_island(rng, 3));
  const std::vector<Placement> placements = pack_in_rows(islands, {});
  const auto placed = [&](std::size_t k) {
    return std::array<Vec2, 3>{placements[k](islands[k][0]), placements[k](islands[k][1]),
                               placements[k](islands[k][2])};
  };
  for (std::size_t k = 0; k < islands.size(); ++k) {
    for (int sample = 0; sample < 30; ++sample) {
      const double a = uniform(rng, 0, 1), b = uniform(rng, 0, 1 - a);
      const auto [p, q, r] = placed(k);
      const Vec2 point = a * p + b * q + (1 - a - b) * r;
      for (std::size_t j = 0; j < islands.size(); ++j)
        EXPECT_TRUE(j == k || !inside(placed(j), point));
    }
  }
}

TEST(Pack, ASquareFillsThePageUpToThePadding) {
  const std::vector<UvMap> islands{{{0, 0}, {3, 3}, {0, 6}, {-3, 3}}};  // standing on a corner
  const std::vector<Placement> placements =
      pack_in_rows(islands, {.resolution = 100, .padding = 5});
  const Extent box = extent_of(islands[0], placements[0]);
  EXPECT_NEAR(box.low.x(), 0.05, 1e-6);
  EXPECT_NEAR(box.high.y(), 0.95, 1e-6);
}

TEST(Pack, EqualSquaresFillMostOfThePage) {
  const std::vector<UvMap> islands(100, UvMap{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const double scale = pack_in_rows(islands, {.resolution = 4096, .padding = 1}).front().scale;
  EXPECT_GT(100 * scale * scale, 0.98);
}

TEST(Pack, PaddingShrinksWhenTooManyIslandsCome) {
  Rng rng(5);
  std::vector<UvMap> islands;
  for (int k = 0; k < 400; ++k) islands.push_back(random_island(rng, 3));
  expect_apart(islands, {.resolution = 64, .padding = 8}, 1.5);
  EXPECT_GT(pack_in_rows(islands, {.resolution = 64, .padding = 8}).front().scale, 0);
}

TEST(Pack, IslandsWithoutExtentArePlacedApartToo) {
  expect_apart(std::vector<UvMap>(50, UvMap{{1, 1}, {1, 1}}), {}, 2);
  expect_apart({{{0, 0}, {1, 0}}, {{0, 0}, {0, 1}}, {{2, 2}}}, {}, 2);
  EXPECT_TRUE(pack_in_rows({}, {}).empty());
}

TEST(Pack, ScaleOfTheIslandsDoesNotMatter) {
  Rng rng(6);
  std::vector<UvMap> islands, larger;
  for (int k = 0; k < 40; ++k) islands.push_back(random_island(rng, 6));
  for (const UvMap& island : islands) {
    larger.push_back(island);
    for (Vec2& uv : larger.back()) uv *= 1024;
  }
  const auto a = pack_in_rows(islands, {}), b = pack_in_rows(larger, {});
  for (std::size_t k = 0; k < islands.size(); ++k)
    EXPECT_LT((a[k](islands[k][0]) - b[k](larger[k][0])).norm(), 1e-9);
}

}  // namespace
}  // namespace unwrapd::pack
