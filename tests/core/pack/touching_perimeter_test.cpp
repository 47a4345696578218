#include "core/pack/touching_perimeter.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/pack/pack_many.hpp"
#include "tests/core/outlines.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::pack {
namespace {

using shapes::net;
using shapes::pack_alone;
using shapes::polygon;
using shapes::stars;

constexpr TouchingRules kRules{.low = 0.2, .large = 0.45};

std::vector<charts::Outline> nets(int count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> side(0.4, 1);
  std::vector<charts::Outline> all;
  for (int k = 0; k < count; ++k) all.push_back(net(side(rng), side(rng), 0));
  return all;
}

std::vector<charts::Outline> squares(int count) {
  return std::vector<charts::Outline>(static_cast<std::size_t>(count),
                                      polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
}

TEST(TouchingPerimeter, SquaresTileTheStrip) {
  const std::vector<charts::Outline> islands = squares(64);
  BottomLeftPlacer placer(islands, 4);
  placer.set_scale(10, 0);
  const TouchingPage page = place_by_touching_perimeter(placer, 80, kRules, {});
  EXPECT_EQ(page.height, 80);
  EXPECT_EQ(page.found.side, 80);
}

/// A cell of one island and a cell of another that are nearer than the padding.
TEST(TouchingPerimeter, IslandsKeepThePadding) {
  const std::vector<charts::Outline> islands = stars(50, 11);
  for (const double padding : {0.0, 1.5, 3.0}) {
    BottomLeftPlacer placer(islands, 8);
    placer.set_scale(6, padding);
    const TouchingPage page = place_by_touching_perimeter(placer, 200, kRules, {});
    ASSERT_GT(page.found.side, 0);
    std::vector<std::vector<int>> owner(300, std::vector<int>(200, -1));
    for (std::size_t k = 0; k < islands.size(); ++k) {
      const CellPlace& spot = page.found.spots[k];
      const Rows& touched = placer.mask_of(k, spot.turn).touched;
      for (int y = 0; y < touched.height(); ++y)
        for (const auto& run : touched.row(y))
          for (int x = run.begin; x < run.end; ++x) {
            int& own = owner.at(std::size_t(spot.y + y)).at(std::size_t(spot.x + x));
            EXPECT_EQ(own, -1);
            own = static_cast<int>(k);
          }
    }
    const int reach = static_cast<int>(padding) + 1;
    for (int y = reach; y + reach < 300; ++y)
      for (int x = reach; x + reach < 200; ++x)
        for (int dy = -reach; dy <= reach; ++dy)
          for (int dx = -reach; dx <= reach; ++dx) {
            const int one = owner[std::size_t(y)][std::size_t(x)];
            const int other = owner[std::size_t(y + dy)][std::size_t(x + dx)];
            if (one < 0 || other < 0 || one == other) continue;
            const double gap =
                std::hypot(std::max(0, std::abs(dx) - 1), std::max(0, std::abs(dy) - 1));
            EXPECT_GE(gap, padding);
          }
  }
}

/// Places are kept from step to step; each must be what a look at every row finds.
TEST(TouchingPerimeter, EveryIslandLiesAtItsLowestFreePlace) {
  for (const unsigned seed : {1, 2, 3}) {
    const std::vector<charts::Outline> islands = stars(45, seed);
    BottomLeftPlacer placer(islands, 8);
    placer.set_scale(8, 2);
    const TouchingPage page = place_by_touching_perimeter(placer, 300, kRules, {});
    ASSERT_GT(page.found.side, 0);
    Budget budget{1'000'000'000};
    const PlacedIslands again = placer.lay(page.found.arrangement, {300, 450, 1}, budget);
    ASSERT_TRUE(again.is_complete);
    EXPECT_EQ(again.top, page.height);
    for (std::size_t k = 0; k < islands.size(); ++k) {
      EXPECT_EQ(again.spots[k].x, page.found.spots[k].x);
      EXPECT_EQ(again.spots[k].y, page.found.spots[k].y);
    }
  }
}

TEST(TouchingPerimeter, AHollowGetsWhatTouchesItAllAround) {
  const charts::Outline cup =
      polygon({{0, 0}, {7.2, 0}, {7.2, 5}, {5.2, 5}, {5.2, 2}, {2, 2}, {2, 5}, {0, 5}});
  const charts::Outline block = polygon({{0, 0}, {3.9, 0}, {3.9, 3}, {0, 3}});
  const charts::Outline square = polygon({{0, 0}, {3, 0}, {3, 3}, {0, 3}});
  const std::vector<charts::Outline> islands{block, square, cup};
  BottomLeftPlacer placer(islands, 1);
  placer.set_scale(10, 0);
  const TouchingPage page = place_by_touching_perimeter(placer, 73, {.low = 0, .large = 0.45}, {});
  EXPECT_EQ(page.found.arrangement.order, (std::vector<Index>{2, 1, 0}));  // the block is larger
  EXPECT_LT(page.found.spots[1].y, 25);  // in the cup, which may lie upside down
}

/// The largest first, each at its lowest place in any turn.
int height_by_size(BottomLeftPlacer& placer, int width) {
  Budget budget{1'000'000'000'000};
  return placer.lay(usual_arrangements(placer)[1], {width, 3 * width, 1}, budget).top;
}

void expect_less_room(const std::vector<charts::Outline>& islands, double share) {
  BottomLeftPlacer placer(islands, 4);
  double area = 0;
  for (std::size_t k = 0; k < islands.size(); ++k) area += placer.box(k).size.prod();
  placer.set_scale(600 / std::sqrt(area), 1);
  EXPECT_LT(place_by_touching_perimeter(placer, 600, kRules, {}).height,
            share * height_by_size(placer, 600));
}

TEST(TouchingPerimeter, TakesLessRoomThanTheLargestFirst) {
  for (const unsigned seed : {1, 2, 3}) {
    expect_less_room(nets(150, seed), 0.95);
    expect_less_room(stars(150, seed), 0.98);
  }
}

TEST(TouchingPerimeter, SaysWhereIslandsDoNotFitIn) {
  const std::vector<charts::Outline> islands = squares(64);
  BottomLeftPlacer placer(islands, 4);
  placer.set_scale(10, 0);
  EXPECT_EQ(place_by_touching_perimeter(placer, 60, kRules, {}).found.side,
            0);  // 60 x 90 cells hold 54
  EXPECT_EQ(place_by_touching_perimeter(placer, 9, kRules, {}).found.side, 0);
}

TEST(TouchingPerimeter, ManyIslandsLieAlikeForAnyNumberOfThreads) {
  const std::vector<charts::Outline> islands = nets(45, 4);
  TwoThreads threads;
  const PackResult one = pack_alone(islands), two = pack(islands, {}, threads);
  for (std::size_t k = 0; k < islands.size(); ++k) {
    EXPECT_EQ(one.placements[k].offset, two.placements[k].offset);
    EXPECT_EQ(one.placements[k].scale, two.placements[k].scale);
  }
}

TEST(TouchingPerimeter, NetsOfBoxesFillThePage) {
  const std::vector<charts::Outline> islands = nets(120, 5);
  double area = 0;
  for (const charts::Outline& island : islands)
    for (const auto& [a, b] : island) area += (a.x() * b.y() - a.y() * b.x()) / 2;
  const double scale = pack_alone(islands).placements.front().scale;
  EXPECT_GT(area * scale * scale, 0.7);
}

TEST(TouchingPerimeter, EndsWhenToldToStop) {
  const std::vector<charts::Outline> islands = squares(64);
  BottomLeftPlacer placer(islands, 4);
  placer.set_scale(10, 0);
  std::stop_source stop;
  stop.request_stop();
  try {
    place_by_touching_perimeter(placer, 80, kRules, stop.get_token());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace unwrapd::pack
