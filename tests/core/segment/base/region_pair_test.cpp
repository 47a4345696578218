#include "core/segment/base/region_pair.hpp"

#include <gtest/gtest.h>

#include "core/segment/base/join.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

/// A sheet of squares in some rows: a flap at the end of the first of them, and the rest.
struct SheetWithFlap {
  SegmentationMesh surface;
  std::array<MappedRegion, 2> regions = {};  ///< the rest, the flap
  std::vector<char> open = std::vector<char>(surface.length.size(), 0);

  SheetWithFlap(Index columns, Index rows, Index flap_rows)
      : surface([&] {
          const TriMesh mesh = shapes::grid(columns, rows, columns, rows);
          return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
        }()) {
    for (Index t = 0; t < surface.face_count(); ++t) {
      const Index column = t / 2 % columns, row = t / 2 / columns;
      MappedRegion& own = regions[column == columns - 1 && row < flap_rows ? 1 : 0];
      own.faces.push_back(t);
      own.area += surface.area(t);
    }
    for (MappedRegion& own : regions) {
      own.uv = projected(surface, own.faces);
      own.is_sound = true;
    }
  }

  /// Turns the map of the flap over: it would lie on the rest.
  void turn_flap_over() {
    for (CornerUv& uv : regions[1].uv)
      for (Vec2& p : uv) p.x() *= -1;
  }

  [[nodiscard]] double covered() const {
    const RegionPair pair(surface, regions[0], regions[1]);
    return pair.covered(pair.place(pair.border(open)), open);
  }
};

TEST(RegionPair, TellsHowMuchLiesOnTheOtherMap) {
  SheetWithFlap sheet(30, 20, 10);
  EXPECT_EQ(sheet.covered(), 0);
  sheet.turn_flap_over();
  EXPECT_EQ(sheet.covered(), 1);
}

TEST(RegionPair, TakesSlitsForBoundary) {
  SheetWithFlap sheet(30, 20, 10);
  const auto count = [&] {
    return boundary_sides(sheet.surface, sheet.open, sheet.regions[0]).size();
  };
  const std::size_t before = count();
  const Index h = 3 * 400 + 1, twin = sheet.surface.halfedges.twin[std::size_t(h)];
  ASSERT_NE(twin, kNoTwin);
  sheet.open[std::size_t(h)] = sheet.open[std::size_t(twin)] = 1;
  EXPECT_EQ(count(), before + 2);
}

TEST(RegionPair, PlacesWhereTheBorderMeets) {
  SheetWithFlap sheet(30, 20, 10);
  for (CornerUv& uv : sheet.regions[1].uv)
    for (Vec2& p : uv) p = Vec2(3 - p.y(), 5 + p.x());  // a quarter turn, and away
  const RegionPair pair(sheet.surface, sheet.regions[0], sheet.regions[1]);
  const Placement placement = pair.place(pair.border(sheet.open));
  EXPECT_NEAR(placement.miss, 0, 1e-12);
  const Region whole =
      beside(sheet.surface, sheet.regions[0], sheet.regions[1], pair.border(sheet.open));
  EXPECT_EQ(whole.uv, placement.both.uv);
  const std::vector<CornerUv> flat = projected(sheet.surface, whole.faces);
  for (std::size_t t = 0; t < whole.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_LT(((whole.uv[t][i] - whole.uv[0][0]) - (flat[t][i] - flat[0][0])).norm(), 1e-12);
}

TEST(Join, TriesNothingThatLiesOnTheLargeRegion) {
  SheetWithFlap small(30, 20, 10);
  const auto joined = [](const SheetWithFlap& sheet) {
    return Joiner(sheet.surface).join(sheet.regions[0], sheet.regions[1], sheet.open, 1, {});
  };
  EXPECT_EQ(joined(small).verdict, Verdict::sound);
  small.turn_flap_over();
  EXPECT_EQ(joined(small).verdict, Verdict::flawed);
  EXPECT_TRUE(joined(small).region.faces.empty());
  SheetWithFlap two_faces(520, 1, 1);  // too few to tell
  two_faces.turn_flap_over();
  EXPECT_FALSE(joined(two_faces).region.faces.empty());
}

TEST(Join, LaysTheSmallerBesideTheLarger) {
  const SheetWithFlap sheet(30, 20, 10);
  const Joined joined =
      Joiner(sheet.surface).join(sheet.regions[1], sheet.regions[0], sheet.open, 1, {});
  ASSERT_EQ(joined.verdict, Verdict::sound);
  EXPECT_EQ(joined.region.faces.front(), sheet.regions[0].faces.front());
}

/// .017 of the sheet is added, after .02: more than .03 since it was mapped as a whole.
TEST(Join, MapsAllAnewOnceEnoughWasAdded) {
  const SheetWithFlap sheet(30, 20, 10);
  MappedRegion rest = sheet.regions[0];
  const MappedRegion& flap = sheet.regions[1];
  const RegionPair pair(sheet.surface, rest, flap);
  const Region laid = pair.place(pair.border(sheet.open)).both;
  const MappedRegion once = unite(rest, flap, laid);
  EXPECT_EQ(once.mapped, rest.faces.size());
  EXPECT_DOUBLE_EQ(once.area_added, flap.area);
  rest.area_added = 0.02;
  const MappedRegion twice = unite(rest, flap, laid);
  EXPECT_EQ(twice.mapped, 0U);
  EXPECT_EQ(twice.area_added, 0);
  EXPECT_NEAR(twice.area, 1, 1e-12);
}

/// Of 1,100 faces a rim of eight times a tenth would be most.
TEST(Join, MapsAllAnewWhereTheRimWouldBeMostOfIt) {
  MappedRegion large, small;
  large.faces.resize(1000);
  large.area = 0.98;
  small.faces.resize(100);
  small.area = 0.02;
  Region laid;
  laid.faces.resize(1100);
  ASSERT_TRUE(is_small_beside(small, large));
  const MappedRegion both = unite(large, small, laid);
  EXPECT_EQ(both.mapped, 0U);
  EXPECT_EQ(both.area_added, 0);
  small.faces.resize(50);
  laid.faces.resize(1050);
  EXPECT_EQ(unite(large, small, laid).mapped, 1000U);
}

}  // namespace
}  // namespace unwrapd::segment
