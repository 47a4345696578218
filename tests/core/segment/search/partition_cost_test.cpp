#include "core/segment/search/partition_cost.hpp"

#include <gtest/gtest.h>

#include "tests/core/shapes.hpp"

namespace unwrapd::segment::search {
namespace {

/// A flat strip 16 wide and 1 high: as one chart, and as 2 that leave a page no fuller than they
/// must.
struct Strip {
  SegmentationMesh surface;
  Partition whole, halves;

  Strip() {
    const TriMesh mesh = shapes::grid(32, 2, 16, 1);
    surface = make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
    const double middle = surface.mesh.positions[16].x();
    whole = halves = {{}, std::vector<char>(surface.length.size(), 0)};
    whole.regions.resize(1);
    halves.regions.resize(2);
    for (Index t = 0; t < surface.face_count(); ++t) {
      double x = 0;
      for (const Index v : surface.mesh.faces[std::size_t(t)])
        x += surface.mesh.positions[std::size_t(v)].x() / 3;
      whole.regions[0].faces.push_back(t);
      halves.regions[x < middle ? 0 : 1].faces.push_back(t);
    }
    for (Partition* own : {&whole, &halves})
      for (MappedRegion& region : own->regions) region.uv = projected(surface, region.faces);
    whole.regions[0].area = 1;
    for (MappedRegion& half : halves.regions) half.area = 0.5;
  }

  [[nodiscard]] PartitionCost cost(CostRules rules) const {
    rules.chart = 0.15;
    return partition_cost(surface, halves, rules);
  }
};

TEST(PartitionCost, IsNothingWithoutASeam) {
  const Strip strip;
  EXPECT_EQ(partition_cost(strip.surface, strip.whole, {}).all, 0);
}

TEST(PartitionCost, CountsSeamsChartsAndWhatThePageLeavesEmpty) {
  const Strip strip;
  const double seam = 0.25;  // the strip's height: its area is 1
  const PartitionCost none = strip.cost({.wanted_fill = 0.1});
  EXPECT_NEAR(none.seams, seam + 2 * 0.15, 1e-5);
  EXPECT_EQ(none.all, none.seams);  // the page is full enough
  const PartitionCost empty = strip.cost({.wanted_fill = 0.7});
  EXPECT_EQ(empty.seams, none.seams);
  const double share = (empty.all - empty.seams) / kCostOfEmptiness;
  EXPECT_GT(share, 0.3);  // 2 charts 8 long and 1 high fill 1/4 of a page
  EXPECT_LT(share, 0.5);
  EXPECT_EQ(strip.cost({.page_area = 2, .wanted_fill = 0.7}).all, none.seams);
}

TEST(PartitionCost, TakesLessForACreaseButTellsItsLength) {
  Strip strip;
  for (double& cost : strip.surface.seam_cost) cost *= 0.6;
  const PartitionCost cost = strip.cost({.wanted_fill = 0.1});
  EXPECT_NEAR(cost.seams, 0.6 * 0.25 + 2 * 0.15, 1e-5);
  EXPECT_NEAR(cost.length, 0.25, 1e-5);
}

TEST(PartitionCost, TakesLessForASmallChart) {
  Strip strip;
  strip.halves.regions[1].area = 0.9 * kSmallRegion;
  const CostRules rules{.small_chart = 0.05, .wanted_fill = 0.1};
  EXPECT_NEAR(strip.cost(rules).seams, 0.25 + 0.15 + 0.05, 1e-5);
}

TEST(PartitionCost, IsTheSameWhereItIsBelowTheLimitAndNeverBelowItElsewhere) {
  const Strip strip;
  const PartitionCost all = strip.cost({.wanted_fill = 0.7});
  EXPECT_EQ(strip.cost({.wanted_fill = 0.7, .limit = all.all * 1.01}).all, all.all);
  EXPECT_GE(strip.cost({.wanted_fill = 0.7, .limit = all.seams}).all, all.seams);
  EXPECT_EQ(strip.cost({.wanted_fill = 0.7, .limit = all.seams}).seams, all.seams);
}

}  // namespace
}  // namespace unwrapd::segment::search
