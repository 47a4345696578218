#include "core/segment/search/bisect.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/charts/outline.hpp"
#include "core/pack/pack.hpp"
#include "core/segment/base/labels.hpp"
#include "core/segment/region_charts.hpp"
#include "core/segment/search/merge_search.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment::search {
namespace {

/// A flat ring that is open to the right.
SegmentationMesh open_ring() {
  TriMesh mesh = shapes::grid(60, 4);
  for (Vec3& p : mesh.positions) {
    const double angle = 0.1 + p.x() * 2 * (std::numbers::pi - 0.1), radius = 1 + 0.4 * p.y();
    p = radius * Vec3(std::cos(angle), -std::sin(angle), 0);
  }
  return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
}

Partition whole(const SegmentationMesh& surface) {
  MappedRegion all;
  for (Index t = 0; t < surface.face_count(); ++t) all.faces.push_back(t);
  all.uv = projected(surface, all.faces);
  all.area = 1;
  all.is_sound = true;
  return {{all}, std::vector<char>(surface.length.size(), 0)};
}

TEST(Bisect, CutsARingAcrossWhereItIsFarthestFromItsEnds) {
  const SegmentationMesh surface = open_ring();
  const auto cut = bisect({surface}, whole(surface), 0);
  ASSERT_TRUE(cut);
  ASSERT_EQ(cut->regions.size(), 2U);
  for (const MappedRegion& half : cut->regions) {
    EXPECT_TRUE(half.is_sound);
    EXPECT_NEAR(half.area, 0.5, 0.02);
    EXPECT_NEAR(half.excess.worst(), 0, 1e-9);
    double above = 0;
    for (const Index t : half.faces)
      for (const Index v : surface.mesh.faces[std::size_t(t)])
        above += surface.mesh.positions[std::size_t(v)].y() > 0 ? 1.0 / 3 : 0;
    const double share = above / double(half.faces.size());
    EXPECT_TRUE(share < 0.05 || share > 0.95) << share;
  }
  EXPECT_EQ(cut->regions[0].faces.size() + cut->regions[1].faces.size(),
            std::size_t(surface.face_count()));
}

TEST(Bisect, LeavesATriangleAlone) {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  EXPECT_FALSE(bisect({surface}, whole(surface), 0));
}

/// Four strips that are as long as the page is wide: it is no smaller before all are in halves.
TEST(Bisect, HalvesAllLongRegionsWhereOneAloneGainsNothing) {
  const TriMesh mesh = shapes::grid(160, 4, 160, 4);
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  Partition strips{std::vector<MappedRegion>(4), std::vector<char>(surface.length.size(), 0)};
  for (Index t = 0; t < surface.face_count(); ++t) {
    double y = 0;
    for (const Index v : mesh.faces[std::size_t(t)]) y += mesh.positions[std::size_t(v)].y() / 3;
    strips.regions[std::size_t(y)].faces.push_back(t);
  }
  for (MappedRegion& strip : strips.regions) {
    strip.uv = projected(surface, strip.faces);
    strip.area = 0.25;
    strip.is_sound = true;
  }
  ProgressEstimate untold({});
  FailedTrials failures;
  SerialExecutor serial;
  MergeSearch search({surface, &untold, &failures}, strips, {}, {}, serial);
  EXPECT_GE(search.bisect_regions({strips}).partition.regions.size(), 8U);
}

/// In two rings, a longer and a shorter one, it fills less than half of one.
TEST(Bisect, LetsATorusFillAPage) {
  const charts::Charts all =
      charts::components_of(shapes::surface_of(shapes::torus(48, 24, 1, 0.25)), {});
  const charts::Chart& torus = all.charts.front();
  SerialExecutor serial;
  const Segments segments =
      segment(make_segmentation_mesh(torus.mesh, torus.halfedges), {}, serial);
  std::vector<charts::Outline> outlines;
  for (const charts::Chart& chart : region_charts(torus, segments))
    outlines.push_back(charts::outline_of(chart, chart.start));
  EXPECT_GT(pack::rough_fill(outlines), 0.55);
  EXPECT_LE(outlines.size(), 5U);
}

}  // namespace
}  // namespace unwrapd::segment::search
