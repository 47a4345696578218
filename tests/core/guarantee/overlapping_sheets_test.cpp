#include "core/guarantee/overlapping_sheets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/measure/overlaps.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::guarantee {
namespace {

using shapes::disk_of;

/// The unit square as a strip on a circle, by so many turns.
UvMap wound(const solve::Disk& disk, double turns) {
  UvMap uv = shapes::from_above(disk);
  for (Vec2& p : uv) {
    const double angle = shapes::kTurn * turns * (p.x() + .5), r = 2.5 - p.y();
    p = {r * std::cos(angle), r * std::sin(angle)};
  }
  return uv;
}

TEST(OverlappingSheets, LieOnEachOtherAndNotOnThemselves) {
  for (const double turns : {1.1, 1.4, 1.9, 2.6}) {
    SCOPED_TRACE(turns);
    const auto owned = disk_of(shapes::grid(60, 3));
    const auto pairs =
        measure::overlapping_pairs(owned.disk.faces, wound(owned.disk, turns), 1 << 20);
    ASSERT_FALSE(pairs.empty());
    const auto sheets = overlapping_sheets(*owned.chart, pairs);
    std::array<std::set<Index>, 2> set;
    for (std::size_t k : {0U, 1U}) {
      EXPECT_FALSE(sheets[k].empty());
      set[k] = {sheets[k].begin(), sheets[k].end()};
    }
    bool do_meet = false;
    for (const auto& [s, t] : pairs) {
      for (const auto& own : set) EXPECT_FALSE(own.contains(s) && own.contains(t));
      do_meet |= set[0].contains(s) && set[1].contains(t);
      do_meet |= set[0].contains(t) && set[1].contains(s);
    }
    EXPECT_TRUE(do_meet);
    for (const Index t : set[0]) EXPECT_FALSE(set[1].contains(t));
  }
}

TEST(OverlappingSheets, AreTheLargestOfSeveral) {
  const auto owned = disk_of(shapes::grid(40, 2));
  std::vector<std::array<Index, 2>> pairs{{0, 20}, {1, 21}};
  for (Index k = 0; k < 9; ++k) pairs.push_back({Index(60 + k), Index(120 + k)});
  const auto sheets = overlapping_sheets(*owned.chart, pairs);
  EXPECT_EQ(sheets[0].front() >= 60 && sheets[1].front() >= 60, true);
}

}  // namespace
}  // namespace unwrapd::guarantee
