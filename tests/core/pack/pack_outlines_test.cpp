#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/pack/box.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"
#include "tests/core/outlines.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::pack {
namespace {

using shapes::area;
using shapes::gap;
using shapes::net;
using shapes::pack_alone;
using shapes::polygon;
using shapes::star;
using shapes::stars;

double fill(const std::vector<charts::Outline>& islands, const std::vector<Placement>& placements) {
  double sum = 0;
  for (std::size_t k = 0; k < islands.size(); ++k)
    sum += area(islands[k]) * placements[k].scale * placements[k].scale;
  return sum;
}

/// Returns the share of the page that they fill.
double expect_apart(const std::vector<charts::Outline>& islands, const PageOptions& page) {
  const std::vector<Placement> placements = pack_alone(islands, page).placements;
  std::vector<charts::Outline> placed;
  for (std::size_t k = 0; k < islands.size(); ++k)
    placed.push_back(shapes::placed(islands[k], placements[k]));
  const double padding = double(page.padding) / page.resolution;
  for (std::size_t k = 0; k < placed.size(); ++k) {
    EXPECT_EQ(placements[k].scale, placements[0].scale);
    EXPECT_NEAR(std::hypot(placements[k].cosine, placements[k].sine), 1, 1e-12);
    for (const auto& [p, q] : placed[k]) {
      EXPECT_GE(p.minCoeff(), padding - 1e-12);
      EXPECT_LE(p.maxCoeff(), 1 - padding + 1e-12);
    }
    for (std::size_t j = 0; j < k; ++j) EXPECT_GE(gap(placed[j], placed[k]), padding - 1e-12);
  }
  return fill(islands, placements);
}

TEST(PackOutlines, KeepsIslandsAndTheBorderApartByThePadding) {
  for (int count : {1, 2, 5}) {
    expect_apart(stars(count, 1), {.resolution = 1024, .padding = 2});
    expect_apart(stars(count, 2), {.resolution = 256, .padding = 3});
    expect_apart(stars(count, 3), {.resolution = 4096, .padding = 0});
  }
  expect_apart(stars(6, 4), {.resolution = 64, .padding = 4});
  expect_apart(stars(45, 2), {.resolution = 256, .padding = 3});
}

TEST(PackOutlines, KeepsThePaddingAtEveryEffortAndFillsMoreWithMore) {
  double least = 0;
  for (const Effort effort : {Effort::fast, Effort::balanced, Effort::best}) {
    double all = 0;
    for (const int count : {2, 7, 20})
      all += expect_apart(stars(count, 8), {.resolution = 512, .padding = 2, .effort = effort});
    EXPECT_GT(all, least);
    least = all;
  }
}

/// Small stars behind five large ones.
std::vector<charts::Outline> with_small_ones(int count, unsigned seed) {
  std::vector<charts::Outline> islands = stars(5, seed);
  for (const charts::Outline& own : stars(count, seed + 1))
    islands.push_back(shapes::placed(own, {.scale = 0.06}));
  return islands;
}

TEST(PackOutlines, ManySmallOnesTakeLittleFromFewLargeOnes) {
  const PageOptions page{.resolution = 512, .padding = 2};
  for (const int count : {60, 180}) {
    double alone = 0, together = 0;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      alone += expect_apart(stars(5, seed), page);
      together += expect_apart(with_small_ones(count, seed), page);
    }
    EXPECT_GT(together, alone) << count;
  }
}

TEST(PackOutlines, VeryFewFillNearlyAsMuchAsWithTheMostWork) {
  double usual = 0, best = 0;
  for (int seed = 1; seed <= 4; ++seed)
    for (int count : {2, 3}) {
      const auto islands = stars(count, static_cast<unsigned>(seed));
      usual += fill(islands, pack_alone(islands, {}).placements);
      best += fill(islands, pack_alone(islands, {.effort = Effort::best}).placements);
    }
  EXPECT_GT(usual, 0.98 * best);
}

TEST(PackOutlines, FillsHollowsThatRowsLeaveEmpty) {
  for (int count : {5, 12, 60, 500}) {
    const std::vector<charts::Outline> islands = stars(count, 4);
    std::vector<UvMap> points;
    for (const charts::Outline& island : islands) {
      points.emplace_back();
      for (const auto& [a, b] : island) points.back().push_back(a);
    }
    const double rows = fill(islands, pack_in_rows(points, {})),
                 tight = fill(islands, pack_alone(islands, {}).placements);
    EXPECT_GT(tight, (count < 500 ? 1.2 : 1.05) * rows) << count;
    EXPECT_LT(tight, 1);
  }
}

TEST(PackOutlines, ThousandsLieInRowsAtOnce) {
  const std::vector<charts::Outline> islands(20'000, polygon({{0, 0}, {1, 0}, {0, 1}}));
  const std::vector<UvMap> points(20'000, UvMap{{0, 0}, {1, 0}, {0, 1}});
  EXPECT_EQ(pack_alone(islands).placements.back().offset, pack_in_rows(points, {}).back().offset);
}

TEST(PackOutlines, LaysTheSmallInTheHollowOfTheLarge) {
  const UvMap cup{{0, 0}, {10, 0}, {10, 10}, {9, 10}, {9, 1}, {1, 1}, {1, 10}, {0, 10}};
  const UvMap block{{0, 0}, {7, 0}, {7, 7}, {0, 7}};
  const std::vector<charts::Outline> islands{polygon(cup), polygon(block)};
  EXPECT_GT(pack_alone(islands, {.resolution = 512, .padding = 1}).placements.front().scale,
            0.09);  // 0.1 is all
}

TEST(PackOutlines, GivesTheSamePlacementsForAnyNumberOfThreads) {
  TwoThreads threads;
  for (const auto& islands : {stars(9, 5), with_small_ones(150, 5)}) {
    const auto a = pack_alone(islands).placements, b = pack(islands, {}, threads).placements;
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].offset, b[k].offset);
      EXPECT_EQ(a[k].cosine, b[k].cosine);
    }
  }
}

TEST(PackOutlines, TakesIslandsWithoutExtentAndCrowdedPages) {
  expect_apart({polygon({{0, 0}, {1, 0}}), polygon({{2, 2}, {2, 3}}), polygon({{5, 5}, {6, 6}})},
               {});
  const PackResult crowded = pack_alone(stars(120, 6), {.resolution = 64, .padding = 8});
  EXPECT_GT(crowded.placements.front().scale, 0);
  EXPECT_LT(crowded.padding, 8);
  EXPECT_TRUE(pack_alone({}, {}).placements.empty());
}

TEST(SquarestBox, HasTheLeastLongerSideOfAllAngles) {
  std::mt19937 rng(7);
  for (int k = 0; k < 40; ++k) {
    UvMap points;
    for (const auto& [a, b] : star(rng)) points.emplace_back(3 * a.x(), a.y());
    const Box box = squarest_box(points);
    for (int step = 0; step < 720; ++step) {
      const double angle = step * M_PI / 720;
      Vec2 low = Vec2::Constant(1e300), high = -low;
      for (const Vec2& p : points) {
        const Vec2 q(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                     std::sin(angle) * p.x() + std::cos(angle) * p.y());
        low = low.cwiseMin(q), high = high.cwiseMax(q);
      }
      EXPECT_LE(box.size.maxCoeff(), 1.01 * (high - low).maxCoeff());
    }
  }
}

TEST(PackOutlines, IsRatedAtAGlanceAsItIsPacked) {
  const charts::Outline square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  EXPECT_GT(rough_fill(std::vector<charts::Outline>(4, square)), 0.9);  // they tile the page
  const charts::Outline cross = polygon({{1, 0},
                                         {1.2, 0},
                                         {1.2, 1},
                                         {2.2, 1},
                                         {2.2, 1.2},
                                         {1.2, 1.2},
                                         {1.2, 2.2},
                                         {1, 2.2},
                                         {1, 1.2},
                                         {0, 1.2},
                                         {0, 1},
                                         {1, 1}});
  EXPECT_LT(rough_fill(std::vector<charts::Outline>{cross, cross}), 0.4);
  EXPECT_EQ(rough_fill(std::vector<charts::Outline>{cross, cross}, {0.9}),  // never comes to that
            rough_fill(std::vector<charts::Outline>{cross, cross}));
  const std::vector<charts::Outline> islands = stars(12, 7);
  EXPECT_NEAR(rough_fill(islands), fill(islands, pack_alone(islands, {.padding = 0}).placements),
              0.12);
}

TEST(PackOutlines, AreRatedNoLongerThanUntilThePageIsFullEnough) {
  const std::vector<charts::Outline> islands = stars(12, 7);
  const double all = rough_fill(islands);
  for (const double enough : {0.5 * all, 0.8 * all, 0.999 * all}) {
    EXPECT_GE(rough_fill(islands, {enough}), enough);
    EXPECT_LE(rough_fill(islands, {enough}), all);
  }
  EXPECT_LT(rough_fill(islands, {0.5 * all}), rough_fill(islands, {0.94 * all}));
  EXPECT_LT(rough_fill(islands, {0.97 * all}), all);
}

TEST(PackOutlines, ShapesOfRightAnglesLieAlongThePage) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<double> side(0.4, 1), angle(0, 6);
  std::vector<charts::Outline> nets;
  for (int k = 0; k < 120; ++k) nets.push_back(net(side(rng), side(rng), angle(rng)));
  const std::vector<Placement> placements = pack_alone(nets, {}).placements;
  for (std::size_t k = 0; k < nets.size(); ++k) {
    const auto& [a, b] = nets[k].front();
    const Vec2 way = (placements[k](b) - placements[k](a)).normalized();
    EXPECT_NEAR(way.x() * way.y(), 0, 1e-9);
  }
}

TEST(PageGrid, GapsOfWholeCellsAreWideEnoughAndHardlyWider) {
  for (const int resolution : {256, 1024, 4096})
    for (const double padding : {1.0, 2.0, 8.0})
      for (const int wanted : {512, 1024, 3000}) {
        const PageGrid grid{padding / resolution};
        const int side = grid.tight_side(wanted);
        const double cells = grid.padding(side);
        if (grid.padding(wanted) < 0.5) {
          EXPECT_EQ(side, wanted);  // no side near to it will do
          continue;
        }
        EXPECT_LE(std::ceil(cells) * grid.cell(side) * resolution, 1.01 * padding);
        EXPECT_GT(std::ceil(cells) * grid.cell(side) * resolution, padding);
        EXPECT_NEAR(side, wanted, wanted / std::round(grid.padding(wanted)));
      }
}

/// What masks cost grows with the square of it.
TEST(PageGrid, PaddingHasFewCellsHoweverMuchOfThePageItIs) {
  for (const double border : {0.002, 0.05, 0.1, 0.2, 0.25})
    for (const int wanted : {512, 1024, 4096}) {
      const PageGrid grid{border};
      const double cells = grid.padding(grid.tight_side(wanted));
      EXPECT_LE(std::ceil(cells), kMostPaddingCells) << border << " of " << wanted;
      EXPECT_GT(std::ceil(cells), 0);
    }
}

}  // namespace
}  // namespace unwrapd::pack
