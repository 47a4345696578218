#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/pack/compact.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/row_prefix_sums.hpp"
#include "tests/core/outlines.hpp"

namespace unwrapd::pack {
namespace {

using shapes::pack_alone;

/// The part of a convex polygon on the left of a line through `at` along `way`.
UvMap left_part(const UvMap& polygon, const Vec2& at, const Vec2& way) {
  const Vec2 normal(-way.y(), way.x());
  UvMap part;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double p = normal.dot(a - at), q = normal.dot(b - at);
    if (p >= 0) part.push_back(a);
    if ((p > 0 && q < 0) || (p < 0 && q > 0)) part.push_back(a + (b - a) * (p / (p - q)));
  }
  return part;
}

double polygon_area(const UvMap& polygon) {
  double area = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return area;
}

/// A square of side 1 cut into pieces by straight lines, each turned by some angle: they fill a
/// page wholly.
std::vector<charts::Outline> puzzle(std::size_t count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  std::vector<UvMap> pieces{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  while (pieces.size() < count) {
    const auto largest = std::ranges::max_element(
        pieces, [](const UvMap& a, const UvMap& b) { return polygon_area(a) < polygon_area(b); });
    Vec2 middle = Vec2::Zero();
    for (const Vec2& p : *largest) middle += p / double(largest->size());
    const double turn = angle(rng);
    const Vec2 way(std::cos(turn), std::sin(turn));
    UvMap other = left_part(*largest, middle, -way);
    *largest = left_part(*largest, middle, way);
    pieces.push_back(std::move(other));
  }
  std::vector<charts::Outline> outlines;
  for (UvMap& piece : pieces) {
    const double turn = angle(rng);
    for (Vec2& p : piece)
      p = Vec2(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
               std::sin(turn) * p.x() + std::cos(turn) * p.y());
    outlines.push_back(shapes::polygon(piece));
  }
  return outlines;
}

TEST(Compact, PutsMostOfAPuzzleTogether) {
  double fill = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const double scale =
        pack_alone(puzzle(6 + seed, seed), {.resolution = 1024, .padding = 0}).placements[0].scale;
    fill += scale * scale / 8;
  }
  EXPECT_GT(fill, 0.81);
}

struct Squeezing {
  explicit Squeezing(const std::vector<charts::Outline>& islands) : placer(islands, 12) {
    placer.set_scale(60, 1.5);
    at_one_place.arrangement.turn.assign(islands.size(), 0);
    at_one_place.spots.assign(islands.size(), {10, 10, 0, 0});
    at_one_place.side = 100;
  }

  BottomLeftPlacer placer;
  CellPacking at_one_place;
};

/// How often each cell of the page is taken; others' cells near to an island's count as its own.
int clashes(BottomLeftPlacer& placer, const CellPacking& found) {
  int count = 0;
  for (std::size_t a = 0; a < found.spots.size(); ++a) {
    std::set<std::pair<int, int>> near;
    const CellPlace& at = found.spots[a];
    const Mask& own = placer.mask_of(a, at.turn);
    for (int y = 0; y < own.grown.height(); ++y)
      for (const Run& run : own.grown.row(y))
        for (int x = run.begin; x < run.end; ++x)
          near.insert({at.x - own.margin + x, at.y - own.margin + y});
    for (std::size_t b = 0; b < found.spots.size(); ++b) {
      const CellPlace& there = found.spots[b];
      const Rows& touched = placer.mask_of(b, there.turn).touched;
      for (int y = 0; y < touched.height(); ++y)
        for (const Run& run : touched.row(y))
          for (int x = run.begin; x < run.end; ++x)
            if (a != b && near.contains({there.x + x, there.y + y})) ++count;
    }
  }
  return count;
}

TEST(Compact, PartsWhatLiesOnOnePlaceAndStaysOnThePage) {
  const std::vector<charts::Outline> islands = puzzle(9, 3);
  for (const int reach : {0, 5}) {
    Squeezing squeezing(islands);
    Budget budget{100'000'000, {}};
    const CellPacking found = compact(squeezing.placer, squeezing.at_one_place,
                                      {.side = 70, .reach = reach, .failures = 3}, budget);
    ASSERT_GT(found.side, 60);  // cells of all islands
    EXPECT_LT(found.side, 90) << reach;
    EXPECT_EQ(clashes(squeezing.placer, found), 0);
    for (std::size_t k = 0; k < islands.size(); ++k) {
      const CellPlace& spot = found.spots[k];
      const Mask& mask = squeezing.placer.mask_of(k, spot.turn);
      EXPECT_EQ(found.arrangement.turn[k], spot.turn);
      EXPECT_GE(std::min(spot.x, spot.y), 0);
      EXPECT_LE(spot.x + mask.width, found.side);
      EXPECT_LE(spot.y + mask.touched.height(), found.side);
    }
  }
}

TEST(Compact, FindsNothingWithoutABudget) {
  const std::vector<charts::Outline> islands = puzzle(9, 3);
  Squeezing squeezing(islands);
  Budget budget{0, {}};
  EXPECT_EQ(compact(squeezing.placer, squeezing.at_one_place, {.side = 70}, budget).side, 0);
}

bool covers(const Rows& rows, int x, int y) {
  if (y < 0 || y >= rows.height()) return false;
  const auto row = rows.row(y);
  return std::ranges::any_of(row, [&](const Run& run) { return run.begin <= x && x < run.end; });
}

TEST(RowPrefixSums, FindsTheLeastWeightOfAColumnBruteForce) {
  std::mt19937 rng(5);
  const double padding = 2;
  const CellWindow window{-3, 90, -2, 110};
  std::vector<Mask> masks;
  for (const charts::Outline& star : shapes::stars(12, 3))
    masks.push_back(make_mask(star, {1, 0, 4}, padding));
  for (int round = 0; round < 200; ++round) {
    RowPrefixSums table;
    table.reset(window);
    std::map<std::pair<int, int>, int> weight;
    for (int k = 0; k < 9; ++k) {
      const Rows& touched = masks[rng() % masks.size()].touched;
      const int x = int(rng() % 80) - 10, y = int(rng() % 100) - 10, own = 1 + int(rng() % 900);
      table.take(touched, x, y, own);
      for (int v = 0; v < touched.height(); ++v)
        for (int u = 0; u < 100; ++u)
          if (covers(touched, u, v)) weight[{x + u, y + v}] += own;
    }
    table.sum_up();
    const Mask& mask = masks[rng() % masks.size()];
    const int rightmost = window.x_end - mask.width - mask.margin;
    const int highest = window.y_end - mask.touched.height() - mask.margin;
    const int x = round % 3 == 0 ? rightmost : int(rng() % 40), first = int(rng() % 20);
    const int last = round % 2 == 0 ? highest : first + int(rng() % 20);
    LeastOverlap expected{0, 1 << 28};
    for (int y = first; y <= last; ++y) {
      int sum = 0;
      for (int v = 0; v < mask.grown.height(); ++v)
        for (int u = 0; u < mask.width + 2 * mask.margin; ++u)
          if (covers(mask.grown, u, v)) sum += weight[{x + u - mask.margin, y + v - mask.margin}];
      if (sum < expected.weight) expected = {y, sum};
    }
    const LeastOverlap found = table.least(mask, x, first, last, RowPrefixSums::kTooMuch);
    EXPECT_EQ(found.weight, expected.weight);
    EXPECT_EQ(found.y, expected.y);
    EXPECT_EQ(table.least(mask, x, first, last, expected.weight + 1).y, expected.y);
    EXPECT_EQ(table.least(mask, x, first, last, expected.weight).weight, RowPrefixSums::kTooMuch);
  }
}

}  // namespace
}  // namespace unwrapd::pack
