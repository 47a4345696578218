// Where seams run on surfaces that are painted against them. The lengths are measured here from
// half-edges of charts, not by the weights that the search adds up.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "core/charts/cut.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/charts/shortest_seam.hpp"
#include "core/segment/base/segmentation_mesh.hpp"
#include "core/segment/coarsen.hpp"
#include "core/segment/large_charts.hpp"
#include "tests/core/segment/cut_up.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;
using Paint = std::function<double(const Vec3&)>;

double nothing(const Vec3&) { return 0; }

Surface painted(const TriMesh& mesh, const Paint& paint) {
  Surface surface = surface_of(mesh);
  for (const Vec3& p : mesh.positions) surface.seam_avoid.push_back(paint(p));
  return surface;
}

Cut cut_painted(const Surface& surface, const SegmentOptions& options = {}) {
  SerialExecutor serial;
  Cut result{{charts::components_of(surface, {})}, {}};
  result.note = segment_charts(result.surfaces, options, {}, serial);
  return result;
}

/// The length of seams, and of those with a painted end, by edges that charts have on boundaries
/// but the surface has twice.
struct SeamLengths {
  double all = 0, painted = 0;
};

SeamLengths lengths_of(const std::vector<charts::Chart>& charts, const Surface& surface,
                       const Paint& paint) {
  std::map<std::set<Index>, int> sides;
  for (const Triangle& face : surface.mesh.faces)
    for (std::size_t i = 0; i < 3; ++i) ++sides[{face[i], face[(i + 1) % 3]}];
  SeamLengths lengths;
  for (const charts::Chart& chart : charts)
    for (const BoundaryLoop& loop : chart.loops)
      for (const Index h : loop) {
        const Triangle& face =
            surface.mesh.faces[std::size_t(chart.face_source[std::size_t(h / 3)])];
        const Index a = face[std::size_t(h % 3)], b = face[std::size_t((h + 1) % 3)];
        if (sides.at({a, b}) != 2) continue;
        const Vec3 &p = surface.mesh.positions[std::size_t(a)],
                   &q = surface.mesh.positions[std::size_t(b)];
        const double length = (p - q).norm() / 2;  // from either side
        lengths.all += length;
        lengths.painted += length * (paint(p) + paint(q)) / 2;
      }
  return lengths;
}

SeamLengths lengths_of(const Cut& cut, const Surface& surface, const Paint& paint) {
  return lengths_of(cut.surfaces.front().charts, surface, paint);
}

/// Half spaces on the four sides of the z axis, their limits left out.
std::vector<Paint> halves() {
  std::vector<Paint> all;
  for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    all.emplace_back([side](const Vec3& p) { return p.dot(side) > 1e-9 ? 1.0 : 0.0; });
  return all;
}

TEST(PaintedSeams, SlitATubeInTheHalfThatIsNotPainted) {
  const TriMesh tube = cylinder(24, 8);
  const Surface bare = surface_of(tube);
  const SegmentOptions bound{.max_distortion = kDefaultDistortion};
  const Cut as_usual = cut_painted(bare, bound);
  int crossed = 0;
  for (const Paint& paint : halves()) {
    const Surface surface = painted(tube, paint);
    const Cut cut = cut_painted(surface, bound);
    expect_sound(cut, tube.faces.size());
    EXPECT_EQ(lengths_of(cut, surface, paint).painted, 0);
    EXPECT_LE(lengths_of(cut, surface, paint).all, 4 + 1e-9);  // at most twice, straight along it
    crossed += lengths_of(as_usual, bare, paint).painted > 0 ? 1 : 0;
  }
  EXPECT_GT(crossed, 0);  // where nothing is painted
}

TEST(PaintedSeams, OpenASphereInTheHalfThatIsNotPainted) {
  const TriMesh ball = sphere(3);
  for (const double side : {-1.0, 1.0}) {
    const auto paint = [&](const Vec3& p) { return side * p.y() > 1e-9 ? 1.0 : 0.0; };
    const Surface surface = painted(ball, paint);
    const SeamLengths lengths =
        lengths_of(cut_painted(surface, {.one_chart_each = true}), surface, paint);
    EXPECT_EQ(lengths.painted, 0);
    EXPECT_GT(lengths.all, 2);
  }
}

double stripe(const Vec3& p) { return std::abs(p.z()) < 0.35 ? 1 : 0; }

TEST(PaintedSeams, CrossAStripeOfASphereLess) {
  const TriMesh ball = sphere(3);
  const Surface bare = surface_of(ball), surface = painted(ball, stripe);
  for (const Effort effort : {Effort::fast, Effort::balanced}) {
    const Cut before = cut_painted(bare, {.effort = effort});
    const Cut after = cut_painted(surface, {.effort = effort});
    expect_sound(after, ball.faces.size());
    EXPECT_LE(distortion_by_svd(after)[0], kDefaultDistortion);
    EXPECT_LE(distortion_by_svd(after)[1], kDefaultDistortion);
    EXPECT_LT(lengths_of(after, surface, stripe).painted,
              0.7 * lengths_of(before, bare, stripe).painted);
    EXPECT_LT(lengths_of(after, surface, stripe).all, 1.5 * lengths_of(before, bare, stripe).all);
  }
}

TEST(PaintedSeams, AreTheSameWhereNothingIsPainted) {
  for (const TriMesh& mesh : {sphere(2), torus(16, 8), cube(2), cylinder(12, 4)})
    for (const SegmentOptions& options :
         {SegmentOptions{}, SegmentOptions{.max_charts = 1}, SegmentOptions{.one_chart_each = true},
          SegmentOptions{.max_distortion = 2.1, .symmetry = Symmetry::automatic}}) {
      const Cut bare = cut_painted(surface_of(mesh), options);
      const Cut zero = cut_painted(painted(mesh, nothing), options);
      ASSERT_EQ(faces_of(bare), faces_of(zero));
      for (std::size_t k = 0; k < faces_of(bare).size(); ++k) {
        const charts::Chart &one = bare.surfaces[0].charts[k], &other = zero.surfaces[0].charts[k];
        EXPECT_EQ(one.mesh.faces, other.mesh.faces);
        EXPECT_EQ(one.start, other.start);
      }
    }
}

TEST(PaintedSeams, AreTheSameForAMovedScaledMeshAndAnyThreads) {
  const TriMesh ball = sphere(2);
  TriMesh moved = ball;
  for (Vec3& p : moved.positions) p = 4 * p + Vec3(8, 0, -16);
  const Cut cut = cut_painted(painted(ball, stripe));
  Surface other = painted(ball, stripe);
  other.mesh = moved;
  EXPECT_EQ(faces_of(cut), faces_of(cut_painted(other)));
  TwoThreads two;
  Cut again{{charts::components_of(painted(ball, stripe), {})}, {}};
  segment_charts(again.surfaces, {}, {}, two);
  EXPECT_EQ(faces_of(cut), faces_of(again));
}

TEST(PaintedSeams, CostTheirLengthTimesWhatIsPaintedOnBothEnds) {
  const TriMesh ball = sphere(1);
  const auto height = [](const Vec3& p) { return (1 + p.z()) / 2; };
  const charts::Charts charts = charts::components_of(painted(ball, height), {});
  const charts::Chart& component = charts.charts.front();
  const SegmentationMesh bare = make_segmentation_mesh(component.mesh, component.halfedges);
  const SegmentationMesh surface = make_segmentation_mesh(component);
  for (std::size_t h = 0; h < surface.length.size(); ++h) {
    const Triangle& face = component.mesh.faces[h / 3];
    const double a = height(component.mesh.positions[std::size_t(face[h % 3])]),
                 b = height(component.mesh.positions[std::size_t(face[(h + 1) % 3])]);
    const double factor = 1 + charts::kAvoidance * (a + b) / 2;
    EXPECT_NEAR(surface.length[h], factor * bare.length[h], 1e-12);
    EXPECT_NEAR(surface.seam_cost[h], factor * bare.seam_cost[h], 1e-12);
  }
}

/// Copies of vertices, as exporters make them for normals, may be painted differently on each side.
TEST(PaintedSeams, TakeTheMeanOfTheSidesWhereVerticesAreCopied) {
  Surface apart = surface_of(soup(grid(1, 1)));  // two triangles over six vertices
  apart.seam_avoid = {1, 1, 1, 0, 0, 0};
  const charts::Charts charts = charts::components_of(apart, {.mode = SeamMode::none});
  const charts::Chart& both = charts.charts.front();
  ASSERT_EQ(charts.charts.size(), 1U);
  for (std::size_t h = 0; h < 6; ++h)
    EXPECT_EQ(both.avoid[h], both.halfedges.twin[h] != kNoTwin ? 0.5 : h < 3 ? 1 : 0);
}

TEST(PaintedSeams, FollowTheCoarseMeshOfALargeSurface) {
  const TriMesh tube = cylinder(60, 30);
  SerialExecutor serial;
  const SegmentRules rules;
  double before = 0, after = 0;
  for (const Paint& paint : halves())
    for (const Surface& surface : {surface_of(tube), painted(tube, paint)}) {
      const charts::Charts charts = charts::components_of(surface, {});
      const LargeCharts large = large_charts(charts.charts.front(), rules, {.faces = 400}, serial);
      const double own = lengths_of(large.charts, surface, paint).painted;
      (surface.seam_avoid.empty() ? before : after) += own;
    }
  EXPECT_LT(after, 0.6 * before);
}

TEST(PaintedSeams, HaveTheMeanOfEachClusterOnACoarseMesh) {
  const Surface surface = painted(torus(40, 20), [](const Vec3& p) { return p.x() > 0 ? 1 : 0; });
  const charts::Charts charts = charts::components_of(surface, {});
  const charts::Chart& component = charts.charts.front();
  Coarse coarse = coarsen(component.mesh, component.halfedges, 200, {});
  EXPECT_TRUE(coarse_avoid(coarse, component.mesh, component.halfedges).empty());
  coarse.avoid = component.avoid;
  const std::vector<double> avoid = coarse_avoid(coarse, component.mesh, component.halfedges);
  ASSERT_EQ(avoid.size(), 3 * coarse.mesh.faces.size());
  for (std::size_t h = 0; h < avoid.size(); ++h) {
    EXPECT_EQ(avoid[h], avoid[std::size_t(coarse.halfedges.twin[h])]);
    const Triangle& face = coarse.mesh.faces[h / 3];
    const double x = coarse.mesh.positions[std::size_t(face[h % 3])].x(),
                 y = coarse.mesh.positions[std::size_t(face[(h + 1) % 3])].x();
    if (std::min(x, y) > 0.4) {
      EXPECT_EQ(avoid[h], 1);
    } else if (std::max(x, y) < -0.4) {
      EXPECT_EQ(avoid[h], 0);
    }
  }
}

TEST(PaintedSeams, AvoidOnBothSidesOfAMirrorWhatIsPaintedOnOne) {
  const TriMesh ball = sphere(3);
  const auto half = [](const Vec3& p) { return p.x() > 0 ? stripe(p) : 0; };
  const SegmentOptions options{.symmetry = Symmetry::automatic};
  const Surface bare = surface_of(ball), surface = painted(ball, half);
  const Cut before = cut_painted(bare, options), after = cut_painted(surface, options);
  expect_sound(after, ball.faces.size());
  EXPECT_LT(lengths_of(after, surface, half).painted, 0.8 * lengths_of(before, bare, half).painted);
}

/// A cut graph of a torus must cross any half of it; less of it can run there.
TEST(PaintedSeams, CutHandlesWhereLessIsPainted) {
  const TriMesh ring = torus(32, 16);
  const auto half = [](const Vec3& p) { return p.x() > 0 ? 1.0 : 0.0; };
  const Surface bare = surface_of(ring), surface = painted(ring, half);
  const SegmentOptions one{.one_chart_each = true};
  const SeamLengths before = lengths_of(cut_painted(bare, one), bare, half);
  const SeamLengths after = lengths_of(cut_painted(surface, one), surface, half);
  EXPECT_LT(after.painted, before.painted);
}

TEST(PaintedSeams, AreTheShortestBetweenFacesByWhatTheyCost) {
  const auto left = [](const Vec3& p) { return p.x() < 0.5 ? 1.0 : 0.0; };
  const charts::Charts charts = charts::components_of(painted(grid(8, 2, 1, 0.2), left), {});
  const charts::Chart& strip = charts.charts.front();
  const std::array<std::vector<Index>, 2> ends{{{0}, {strip.mesh.face_count() - 1}}};
  const Halfedges cut = charts::cut_between(strip, ends);
  for (std::size_t h = 0; h < cut.twin.size(); ++h) {
    if (cut.twin[h] == strip.halfedges.twin[h]) continue;
    const Triangle& face = strip.mesh.faces[h / 3];
    for (const std::size_t i : {h % 3, (h + 1) % 3})
      EXPECT_EQ(left(strip.mesh.positions[std::size_t(face[i])]), 0);
  }
}

}  // namespace
}  // namespace unwrapd::segment
