#include "core/solve/repair/patch.hpp"

#include <gtest/gtest.h>

#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;

TEST(Patches, LetRingsLooseAndHoldTheRim) {
  const auto owned = disk_of(shapes::grid(12, 12));
  const Index face = 2 * (6 * 12 + 6);
  for (int rings : {0, 1, 2}) {
    const auto patches = patches_around(owned.disk, std::vector{face}, rings, {});
    ASSERT_EQ(patches.size(), 1U);
    const Patch& patch = patches[0];
    std::vector<int> faces_of(owned.disk.positions.size(), 0);
    for (Index t : patch.face)
      for (Index v : owned.disk.faces[std::size_t(t)]) ++faces_of[std::size_t(v)];
    for (std::size_t k = 0; k < patch.vertex.size(); ++k) {
      const auto v = std::size_t(patch.vertex[k]);
      const Index all = owned.disk.corners.begin[v + 1] - owned.disk.corners.begin[v];
      EXPECT_TRUE(patch.mesh.free.slot[k] == linear::kFixed || faces_of[v] == all) << v;
    }
    for (std::size_t k = 0; k < patch.face.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(patch.vertex[std::size_t(patch.mesh.faces[k][i])],
                  owned.disk.faces[std::size_t(patch.face[k])][i]);
  }
}

TEST(Patches, AreTheWholeWhereMostOfItWouldBeLoose) {
  const auto owned = disk_of(shapes::grid(12, 12));
  const Index face = 2 * (6 * 12 + 6);
  const auto small = patches_around(owned.disk, std::vector{face}, 3, {});
  const auto large = patches_around(owned.disk, std::vector{face}, 5, {});
  ASSERT_EQ(small.size(), 1U);
  ASSERT_EQ(large.size(), 1U);
  EXPECT_LT(small[0].face.size(), owned.disk.faces.size() / 2);
  EXPECT_EQ(large[0].face.size(), owned.disk.faces.size());
  EXPECT_EQ(large[0].mesh.free.count, owned.disk.vertex_count());
}

TEST(Patches, ThatDoNotTouchAreApart) {
  const auto owned = disk_of(shapes::grid(40, 4));
  const std::vector<Index> faces{0, 300};
  EXPECT_EQ(patches_around(owned.disk, faces, 1, {}).size(), 2U);
  EXPECT_EQ(patches_around(owned.disk, faces, 60, {}).size(), 1U);
}

}  // namespace
}  // namespace unwrapd::solve::repair
