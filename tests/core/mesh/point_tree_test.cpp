#include "core/mesh/point_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace unwrapd {
namespace {

/// Points on a coarse lattice, so that many coincide and many are equally near.
std::vector<Vec3> lattice_points(int count, int side, int height, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_int_distribution<int> x(0, side), z(0, height);
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k) points.emplace_back(x(rng), x(rng), z(rng));
  return points;
}

std::vector<Index> every(const std::vector<Vec3>& points, int step) {
  std::vector<Index> of;
  for (std::size_t k = 0; k < points.size(); k += std::size_t(step)) of.push_back(Index(k));
  return of;
}

TEST(PointTree, FindsWhatASearchThroughAllFinds) {
  for (int height : {0, 6})
    for (int count : {1, 2, 3, 400})
      for (int step : {1, 3}) {
        const std::vector<Vec3> points = lattice_points(count, 6, height, 5);
        const std::vector<Index> of = every(points, step);
        const PointTree tree(points, of);
        std::mt19937 rng(7);
        std::uniform_int_distribution<int> twice(-4, 16);
        for (int k = 0; k < 500; ++k) {
          const Vec3 place(twice(rng) / 2.0, twice(rng) / 2.0, twice(rng) / 2.0);
          Index nearest = of.front();
          std::vector<Index> there;
          for (Index i : of) {
            const Vec3& p = points[std::size_t(i)];
            if ((p - place).squaredNorm() < (points[std::size_t(nearest)] - place).squaredNorm())
              nearest = i;
            if (p == place) there.push_back(i);
          }
          EXPECT_EQ(tree.nearest(place), nearest);
          EXPECT_EQ(tree.at(place), there);
        }
      }
}

// Sums of distances are rounded there; nanoflann misses some of the nearest (ADR 0043).
TEST(PointTree, FindsTheLowestAmongPointsAtHalvingDistances) {
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i)
    points.emplace_back(std::ldexp(1, -(i % 1000)), std::ldexp(1, -(i / 7)),
                        std::ldexp(1, -(i / 13)));
  const PointTree tree(points, every(points, 1));
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> x(-1, 1);
  for (int k = 0; k < 500; ++k) {
    const Vec3 place(x(rng), x(rng), x(rng));
    const auto nearer = [&](const Vec3& a, const Vec3& b) {
      return (a - place).squaredNorm() < (b - place).squaredNorm();
    };
    const auto nearest = std::min_element(points.begin(), points.end(), nearer);  // the first one
    EXPECT_EQ(tree.nearest(place), nearest - points.begin());
  }
}

TEST(PointTree, FindsTheNearestOnesWithinARadius) {
  const std::vector<Vec3> points = lattice_points(400, 6, 6, 5);
  const PointTree tree(points, every(points, 1));
  std::mt19937 rng(7);
  std::uniform_int_distribution<int> twice(-4, 16), squared(0, 12);
  for (int k = 0; k < 300; ++k) {
    const Vec3 place(twice(rng) / 2.0, twice(rng) / 2.0, twice(rng) / 2.0);
    const double radius = squared(rng) / 4.0;
    std::vector<std::pair<double, Index>> within;
    for (Index i = 0; i < Index(points.size()); ++i)
      if (const double d2 = (points[std::size_t(i)] - place).squaredNorm(); d2 <= radius * radius)
        within.emplace_back(d2, i);
    std::sort(within.begin(), within.end());
    const std::size_t most = std::size_t(k) % 9 + 1;
    within.resize(std::min(within.size(), most));
    std::vector<Index> expected;
    for (const auto& [d2, i] : within) expected.push_back(i);
    EXPECT_EQ(tree.nearest_within(place, radius, most), expected);
  }
}

TEST(PointTree, AnswersOneOfItsPointsHoweverFarThePlace) {
  const std::vector<Vec3> points = lattice_points(9, 6, 6, 5);
  const PointTree tree(points, {4, 7});
  const Index found = *tree.nearest(Vec3(1e200, 0, 0));
  EXPECT_TRUE(found == 4 || found == 7);
}

TEST(PointTree, FindsNothingAmongNone) {
  const PointTree tree({}, {});
  EXPECT_FALSE(tree.nearest(Vec3::Zero()));
  EXPECT_TRUE(tree.at(Vec3::Zero()).empty());
}

}  // namespace
}  // namespace unwrapd
