#include "core/mesh/weld.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>

#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

TEST(Weld, EqualsASearchThroughAllEarlierPositions) {
  std::mt19937 rng(1);
  for (int k = 0; k < 50; ++k) {
    std::vector<Vec3> positions;
    for (int v = 0; v < 200; ++v)
      positions.emplace_back(rng() % 3, double(rng() % 5) - 2, 1e-9 * double(rng() % 4));
    const std::vector<Index> first_at = weld(positions);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const auto first = std::find(positions.begin(), positions.end(), positions[v]);
      EXPECT_EQ(first_at[v], first - positions.begin());
    }
  }
}

TEST(Weld, NegativeZeroIsZero) {
  const std::vector<Vec3> positions{{0.0, 1, 0}, {-0.0, 1, -0.0}, {0, 1, 1e-300}};
  EXPECT_EQ(weld(positions), (std::vector<Index>{0, 0, 2}));
  std::vector<Vec3> many;  // so many that their order in memory does not help
  for (int k = 0; k < 1000; ++k) many.emplace_back(k % 2 == 0 ? 0.0 : -0.0, k / 2, 0);
  const std::vector<Index> first_at = weld(many);
  for (Index k = 0; k < 1000; ++k) EXPECT_EQ(first_at[k], k / 2 * 2);
}

TEST(Weld, NeighbouringDoublesAreDifferent) {
  const std::vector<Vec3> positions{{1, 0, 0}, {std::nextafter(1.0, 2.0), 0, 0}};
  EXPECT_EQ(weld(positions), (std::vector<Index>{0, 1}));
}

TEST(Weld, ManyVerticesAtOnePlaceAreOne) {
  EXPECT_EQ(weld(std::vector<Vec3>(10'000, Vec3(1, 2, 3))), std::vector<Index>(10'000, 0));
  EXPECT_TRUE(weld({}).empty());
}

TEST(Weld, GivesASoupItsSurfaceBack) {
  const TriMesh mesh = shapes::sphere(2), apart = shapes::soup(mesh);
  const auto faces = renumber(apart.faces, weld(apart.positions));
  std::map<Index, Index> to;
  for (std::size_t t = 0; t < faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(to.try_emplace(mesh.faces[t][i], faces[t][i]).first->second, faces[t][i]);
  EXPECT_EQ(to.size(), mesh.positions.size());
}

}  // namespace
}  // namespace unwrapd
