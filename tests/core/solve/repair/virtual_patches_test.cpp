#include "core/solve/repair/virtual_patches.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::from_above;

std::size_t moved(const UvMap& before, const UvMap& after) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < before.size(); ++v) count += before[v] != after[v] ? 1 : 0;
  return count;
}

TEST(VirtualPatches, MoveOnlyWhatLiesAroundTheFlip) {
  const auto owned = disk_of(shapes::grid(20, 20));
  for (const std::size_t v : {10 * 21 + 10, 21 + 5, 5}) {  // inside, near the boundary, on it
    SCOPED_TRACE(v);
    const UvMap flat = from_above(owned.disk);
    UvMap before = flat;
    before[v] += Vec2(0.07, 0.08);
    ASSERT_FALSE(measure::flipped_faces(owned.disk.faces, before).empty());
    UvMap after = before;
    EXPECT_TRUE(mend_by_virtual_boundary(owned.disk, {}, after));
    EXPECT_TRUE(measure::flipped_faces(owned.disk.faces, after).empty());
    EXPECT_LT(moved(before, after), 80U);  // of 441
    EXPECT_LT(measure::arap_energy(owned.disk.rest, owned.disk.faces, after), 1e-3);
  }
}

TEST(VirtualPatches, NeverMoveHeldVertices) {
  const auto owned = disk_of(shapes::grid(12, 12));
  UvMap before = from_above(owned.disk);
  const std::size_t v = 6 * 13 + 6;
  before[v] += Vec2(0.1, 0.02);
  MapIntent intent{.rigidity = {}, .constrained = std::vector<char>(before.size(), 0), .stop = {}};
  intent.constrained[v] = 1;
  UvMap after = before;
  mend_by_virtual_boundary(owned.disk, intent, after);
  EXPECT_EQ(after[v], before[v]);
  EXPECT_EQ(untangle(owned.disk, intent, after), 0);
}

/// For one flip the whole map used to be made anew: D_angle of Gargoyle went from 2.0506 to 2.1171.
TEST(VirtualPatches, ChangeLittleElseOfThePapersModels) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  for (const char* name : {"Beetle_ABF", "Cow_dABF", "Gargoyle_ABF"}) {
    SCOPED_TRACE(name);
    const auto owned = disk_of(read_obj(test_data() / "paper" / (std::string(name) + ".obj")));
    const Disk& disk = owned.disk;
    SerialExecutor serial;
    const UnwrapOptions options;
    const UvMap before = Solver(disk, options, {}, serial).run(options.lambda, {}).uv;
    ASSERT_FALSE(measure::flipped_faces(disk.faces, before).empty());
    UvMap after = before;
    EXPECT_TRUE(mend_by_virtual_boundary(disk, {}, after));
    EXPECT_TRUE(measure::flipped_faces(disk.faces, after).empty());
    EXPECT_LT(moved(before, after), 60U);
    const auto angle = [&](const UvMap& uv) {
      return measure::distortion(measure::distortion_sums(disk.rest, disk.faces, uv)).angle;
    };
    EXPECT_LT(angle(after), angle(before) + 0.002);
    EXPECT_LT(measure::arap_energy(disk.rest, disk.faces, after),
              1.007 * measure::arap_energy(disk.rest, disk.faces, before));
  }
}

}  // namespace
}  // namespace unwrapd::solve::repair
