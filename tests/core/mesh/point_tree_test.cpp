#include "core/mesh/point_tree.hpp"

#include <gtest/gtest.h>

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
