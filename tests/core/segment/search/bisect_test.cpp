#include "core/segment/search/bisect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

const MergeSettings kLoose{.budget = 1, .cap = 1};

/// A flat ring that is open to the right.
SegmentationMesh open_ring() {
  TriMesh mesh = shapes::grid(60, 4);
  for (Vec3& p : mesh.positions) {
    const double angle = 0.1 + p.x() * 2 * (std::numbers::pi - 0.1), radius = 1 + 0.4 * p.y();
    p = radius * Vec3(std::cos(angle), -std::sin(angle), 0);
  }
  return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
}

/// One region for each value of label(middle of a face), in the plane.
template <class Label>
Partition flat_parts(const SegmentationMesh& surface, Label label) {
  Partition parts{{}, std::vector<char>(surface.length.size(), 0)};
  for (Index t = 0; t < surface.face_count(); ++t) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : surface.mesh.faces[std::size_t(t)])
      middle += surface.mesh.positions[std::size_t(v)] / 3;
    const auto k = std::size_t(label(middle));
    if (parts.regions.size() <= k) parts.regions.resize(k + 1);
    parts.regions[k].faces.push_back(t);
    parts.regions[k].area += surface.area(t);
  }
  for (MappedRegion& region : parts.regions) {
    region.uv = projected(surface, region.faces);
    region.is_sound = true;
  }
  return parts;
}

Partition whole(const SegmentationMesh& surface) {
  return flat_parts(surface, [](const Vec3&) { return 0; });
}

/// The faces of a sheet, with squares of side 1, whose middles fulfil a condition.
template <class IsIn>
SegmentationMesh cut_out(Index columns, Index rows, IsIn is_in) {
  TriMesh mesh = shapes::grid(columns, rows, columns, rows);
  std::erase_if(mesh.faces, [&](const Triangle& face) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : face) middle += mesh.positions[std::size_t(v)] / 3;
    return !is_in(middle.x(), middle.y());
  });
  return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
}

/// The share of the area that the smaller part of two has.
double smaller_part(const Partition& parts) {
  return std::min(parts.regions[0].area, parts.regions[1].area);
}

/// Between a plate and a square lies a bridge, 4 wide and 8 long.
TEST(Bisect, CutsAtTheNeckBeforeATip) {
  const SegmentationMesh surface = cut_out(48, 16, [](double x, double y) {
    return x < 32 || (x < 40 ? std::abs(y - 8) < 2 : std::abs(y - 8) < 4);
  });
  const double all = 32 * 16 + 8 * 4 + 8 * 8;
  const auto cut = bisect({surface}, kLoose, whole(surface), 0, 1);
  ASSERT_TRUE(cut);
  EXPECT_GT(smaller_part(*cut), 8 * 8 / all - 0.01);
  EXPECT_LT(smaller_part(*cut), (8 * 4 + 8 * 8) / all + 0.01);
  const auto halfway = bisect({surface}, kLoose, whole(surface), 0);
  ASSERT_TRUE(halfway);
  EXPECT_GT(smaller_part(*halfway), 0.3);
}

/// The square beyond the bridge is a dome: cut off, it has all of the distortion for itself.
TEST(Bisect, MakesNoPartMoreDistortedThanARegionMayBe) {
  TriMesh mesh = shapes::grid(48, 16, 48, 16);
  std::erase_if(mesh.faces, [&](const Triangle& face) {
    const Vec3& p = mesh.positions[std::size_t(face[0])];
    return p.x() >= 32 && std::abs(p.y() - 8) > (p.x() < 38 ? 2 : 4);
  });
  for (Vec3& p : mesh.positions)
    p.z() = 1.5 * std::max(0., 1 - std::pow(std::hypot(p.x() - 44, p.y() - 8) / 4, 2));
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  const auto cut = bisect({surface}, kLoose, whole(surface), 0, 1);
  ASSERT_TRUE(cut);
  const double worst = std::ranges::max(cut->regions, {}, &MappedRegion::mean_excess).mean_excess();
  ASSERT_GT(worst, 1e-3);
  MergeSettings strict = kLoose;
  strict.cap = 0.9 * worst;
  EXPECT_FALSE(bisect({surface}, strict, whole(surface), 0, 1));
  strict.cap = 1.1 * worst;
  EXPECT_TRUE(bisect({surface}, strict, whole(surface), 0, 1));
}

/// A square with a stub of a twentieth of the area.
TEST(Bisect, CutsNothingOffThatIsTooSmall) {
  const SegmentationMesh surface =
      cut_out(16, 12, [](double x, double y) { return x < 12 || std::abs(y - 6) < 1; });
  for (std::size_t way = 1; way < kWaysToBisect; ++way) {
    const auto cut = bisect({surface}, kLoose, whole(surface), 0, way);
    ASSERT_TRUE(cut) << way;
    EXPECT_GE(smaller_part(*cut), 0.08 - 1e-9) << way;
  }
}

/// A square with a tail, whose tip is a region: halves would part the square.
TEST(Bisect, TakesATailOffWhereAPageStaysEmpty) {
  const SegmentationMesh surface =
      cut_out(44, 24, [](double x, double y) { return x < 24 || std::abs(y - 12) < 2; });
  const double all = 24 * 24 + 20 * 4;
  const double right =
      std::ranges::max(surface.mesh.positions, {}, [](const Vec3& p) { return p.x(); }).x();
  const Partition tailed = flat_parts(surface, [&](const Vec3& middle) {
    return (right - middle.x()) * std::sqrt(all) < 4 ? 1 : 0;
  });
  ProgressEstimate untold({});
  FailedTrials failures;
  SerialExecutor serial;
  MergeSearch search({surface, &untold, &failures}, tailed, kLoose, {}, serial);
  const Partition found = search.bisect_regions({tailed}, 9).partition;
  EXPECT_EQ(found.regions.size(), 3U);
  EXPECT_NEAR(std::ranges::max(found.regions, {}, &MappedRegion::area).area, 24 * 24 / all, 0.01);
}

TEST(Bisect, CutsARingAcrossWhereItIsFarthestFromItsEnds) {
  const SegmentationMesh surface = open_ring();
  const auto cut = bisect({surface}, kLoose, whole(surface), 0);
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
  EXPECT_FALSE(bisect({surface}, kLoose, whole(surface), 0));
}

/// Four strips that are as long as the page is wide: it is no smaller before all are in halves.
TEST(Bisect, HalvesAllLongRegionsWhereOneAloneGainsNothing) {
  const TriMesh mesh = shapes::grid(160, 4, 160, 4);
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  const Partition strips = flat_parts(
      surface, [](const Vec3& middle) { return std::floor(middle.y() * std::sqrt(640) + 2); });
  ProgressEstimate untold({});
  FailedTrials failures;
  SerialExecutor serial;
  MergeSearch search({surface, &untold, &failures}, strips, kLoose, {}, serial);
  EXPECT_GE(search.bisect_regions({strips}, 99).partition.regions.size(), 8U);
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
