#include "core/solve/repair/virtual_boundary.hpp"

#include <gtest/gtest.h>

#include "core/measure/orientation.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::from_above;

double farthest_move(const UvMap& a, const UvMap& b) {
  double farthest = 0;
  for (std::size_t v = 0; v < a.size(); ++v) farthest = std::max(farthest, (a[v] - b[v]).norm());
  return farthest;
}

TEST(VirtualBoundary, LeavesAMapWithoutFlipsWhereItIs) {
  for (const TriMesh& mesh :
       {shapes::grid(8, 8), shapes::annulus(24, 4), shapes::sphere_cap(16, 5)}) {
    const auto owned = disk_of(mesh);
    const UvMap uv = from_above(owned.disk);
    ASSERT_TRUE(measure::flipped_faces(owned.disk.faces, uv).empty());
    EXPECT_LT(farthest_move(virtual_boundary_map(owned.disk, uv), uv), 1e-9);
  }
}

TEST(VirtualBoundary, TurnsEveryFlipBackWhateverTheMap) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::random_disk(Index(2 + seed % 10), seed));
    const UvMap uv = shapes::shaken(from_above(owned.disk), 0.02 * seed, seed);
    EXPECT_TRUE(
        measure::flipped_faces(owned.disk.faces, virtual_boundary_map(owned.disk, uv)).empty());
  }
}

TEST(VirtualBoundary, LetsTheBoundaryKeepItsShape) {
  const auto owned = disk_of(shapes::grid(16, 4, 4, 1));
  UvMap uv = from_above(owned.disk);
  uv[2 * 17 + 8] += Vec2(0.3, 0.02);
  ASSERT_FALSE(measure::flipped_faces(owned.disk.faces, uv).empty());
  const UvMap mended = virtual_boundary_map(owned.disk, uv);
  EXPECT_TRUE(measure::flipped_faces(owned.disk.faces, mended).empty());
  Vec2 low = mended[0], high = mended[0];
  for (const Vec2& u : mended) low = low.cwiseMin(u), high = high.cwiseMax(u);
  EXPECT_GT((high - low).x(), 2.5 * (high - low).y());  // 4 by 1, where a circle is 1 by 1
}

TEST(VirtualBoundary, ClosesHolesWithoutFlips) {
  const auto owned = disk_of(shapes::annulus(20, 2));
  UvMap uv = from_above(owned.disk);
  for (std::size_t v = 0; v < uv.size(); v += 3) uv[v] = -uv[v];
  ASSERT_FALSE(measure::flipped_faces(owned.disk.faces, uv).empty());
  EXPECT_TRUE(
      measure::flipped_faces(owned.disk.faces, virtual_boundary_map(owned.disk, uv)).empty());
}

}  // namespace
}  // namespace unwrapd::solve::repair
