#include "core/segment/segment_charts.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "tests/core/segment/cut_up.hpp"
#include "tests/core/shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;

TEST(SegmentCharts, MakesDisksWithSoundMapsOfShapesOfEveryGenus) {
  for (const TriMesh& mesh : {sphere(2), torus(16, 8), cube(1), pierced_bar(3), sphere(0),
                              soup(cube(1)), sphere_cap(16, 12, 3.1)}) {
    const Cut cut = cut_up(mesh);
    expect_sound(cut, mesh.faces.size());
    ASSERT_EQ(cut.surfaces.front().repairs.size(), 1U);
    EXPECT_EQ(cut.surfaces.front().repairs[0].kind, RepairKind::segmented);
    const auto [angle, area] = distortion_by_svd(cut);
    EXPECT_LE(angle, kDefaultDistortion);
    EXPECT_LE(area, kDefaultDistortion);
  }
}

TEST(SegmentCharts, NeedsFewChartsWhereFewAreEnough) {
  EXPECT_LE(faces_of(cut_up(cube(2))).size(), 2U);
  EXPECT_LE(faces_of(cut_up(torus(24, 12), {.effort = Effort::best})).size(), 4U);
  EXPECT_LE(faces_of(cut_up(sphere(3))).size(), 6U);
}

TEST(SegmentCharts, LeavesADiskWholeUnlessABoundIsAskedFor) {
  const TriMesh cap = sphere_cap(24, 12, 2);
  const Cut whole = cut_up(cap);
  EXPECT_EQ(faces_of(whole).size(), 1U);
  EXPECT_TRUE(whole.surfaces.front().charts[0].start.empty());
  EXPECT_TRUE(whole.surfaces.front().repairs.empty());
  const Cut bounded = cut_up(cap, {.max_distortion = 2.02});
  EXPECT_GT(faces_of(bounded).size(), 1U);
  EXPECT_LE(distortion_by_svd(bounded)[1], 2.02);
  EXPECT_EQ(faces_of(cut_up(grid(6, 6), {.max_distortion = 2.02})).size(), 1U);
}

/// The length of all boundaries of all charts.
double border_of(const Cut& cut) {
  double length = 0;
  for (const charts::Chart& chart : cut.surfaces.front().charts)
    for (const BoundaryLoop& loop : chart.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const auto at = [&](std::size_t i) {
          const Index h = loop[i % loop.size()];
          return chart.mesh.positions[std::size_t(chart.mesh.faces[std::size_t(h / 3)][h % 3])];
        };
        length += (at(k + 1) - at(k)).norm();
      }
  return length;
}

TEST(SegmentCharts, TakesMoreDistortionForShorterSeams) {
  double last = 1e9;
  for (const double bound : {2.002, 2.02, 2.3}) {
    const Cut cut = cut_up(sphere(3), {.max_distortion = bound});
    EXPECT_LE(distortion_by_svd(cut)[0], bound);
    EXPECT_LE(distortion_by_svd(cut)[1], bound);
    EXPECT_LT(border_of(cut), last);
    last = border_of(cut);
  }
}

TEST(SegmentCharts, KeepsToANumberOfChartsWhereMapsAllow) {
  const Cut one = cut_up(sphere(3), {.max_charts = 1});
  EXPECT_EQ(faces_of(one).size(), 1U);
  EXPECT_EQ(one.surfaces.front().repairs.at(0).kind, RepairKind::cut_to_disk);
  const Cut three = cut_up(cube(2), {.max_distortion = 2.0001, .max_charts = 3});
  EXPECT_LE(faces_of(three).size(), 3U);
  EXPECT_FALSE(three.note.has_value());
  const std::vector<TriMesh> pair{cube(1), moved(cube(1), {5, 0, 0})};
  const Cut two_pieces = cut_up(merged(pair), {.max_charts = 1});
  EXPECT_EQ(faces_of(two_pieces).size(), 2U);
  EXPECT_NE(two_pieces.note.value().text.find("2 components"), std::string::npos);
}

/// A cut runs along some edges of a box, and shears its sides.
TEST(SegmentCharts, IsOneChartWithinTheBoundWhereOneWillDo) {
  TriMesh book = cube(2);
  for (Vec3& p : book.positions) p = p.cwiseProduct(Vec3(0.15, 0.21, 0.03));
  const Cut one = cut_up(book, {.max_distortion = 2.02, .max_charts = 1});
  ASSERT_EQ(faces_of(one).size(), 1U);
  EXPECT_LE(distortion_by_svd(one)[0], 2.02);
  EXPECT_LE(distortion_by_svd(one)[1], 2.02);
}

/// A closed tube along a helix.
TriMesh coil(Index around, Index along, int turns) {
  const double length = turns * 2 * std::numbers::pi;
  TriMesh mesh = cylinder(around, along, 0.12, length);
  for (const double end : {0.0, length}) mesh.positions.push_back({0, 0, end});
  for (Index i = 0; i < around; ++i) {
    const Index next = (i + 1) % around, top = around * along;
    mesh.faces.push_back({mesh.vertex_count() - 2, next, i});
    mesh.faces.push_back({mesh.vertex_count() - 1, top + i, top + next});
  }
  for (Vec3& p : mesh.positions) {
    const double turn = p.z(), from_axis = 1 + p.x();
    p = {from_axis * std::cos(turn), from_axis * std::sin(turn), p.y() + 0.06 * turn};
  }
  return mesh;
}

/// No two of the last charts of a spring have a common map without overlaps.
TEST(SegmentCharts, IsCutToOneWhereMergingLeavesTooMany) {
  const TriMesh spring = coil(8, 80, 4);
  ASSERT_GT(faces_of(cut_up(spring, {.max_distortion = 2.02})).size(), 2U);
  const Cut two = cut_up(spring, {.max_distortion = 2.02, .max_charts = 2});
  EXPECT_LE(faces_of(two).size(), 2U);
  EXPECT_FALSE(two.note.has_value());
}

TEST(SegmentCharts, CutsToOneDiskEachWhereComponentsShallStayWhole) {
  const Cut cut = cut_up(torus(16, 8), {.one_chart_each = true});
  EXPECT_EQ(faces_of(cut).size(), 1U);
  EXPECT_EQ(cut.surfaces.front().repairs.at(0).kind, RepairKind::cut_to_disk);
}

TEST(SegmentCharts, FindsTheSameChartsAtEveryScaleAndPlace) {
  const TriMesh mesh = shuffled(torus(16, 8), 3);
  const auto faces = faces_of(cut_up(mesh));
  for (const double scale : {1e-6, 1e6}) {
    TriMesh scaled = mesh;
    for (Vec3& p : scaled.positions) p *= scale;
    EXPECT_EQ(faces_of(cut_up(scaled)), faces);
  }
  EXPECT_EQ(faces_of(cut_up(moved(mesh, {1e5, -1e5, 1e5}))), faces);
}

TEST(SegmentCharts, FindsTheSameMapsOnTwoThreads) {
  const TriMesh mesh = sphere(3);
  const Cut serial = cut_up(mesh);
  TwoThreads two;
  std::vector<charts::Charts> threaded{charts::components_of(surface_of(mesh), {})};
  segment_charts(threaded, {}, {}, two);
  ASSERT_EQ(threaded[0].charts.size(), serial.surfaces[0].charts.size());
  for (std::size_t k = 0; k < threaded[0].charts.size(); ++k)
    EXPECT_EQ(threaded[0].charts[k].start, serial.surfaces[0].charts[k].start);
}

TEST(SegmentCharts, TellsProgressThatNeverGoesBackAndStopsWhenTold) {
  const std::vector<TriMesh> pair{sphere(2), moved(torus(12, 6), {5, 0, 0})};
  double last = 0;
  int events = 0;
  cut_up(merged(pair), {},
         {[&](Stage stage, double share) {
            EXPECT_TRUE(stage == Stage::segment || stage == Stage::merge);
            EXPECT_GE(share, last);
            last = share;
            ++events;
          },
          {}});
  EXPECT_GT(events, 10);
  EXPECT_LE(last, 1);
  for (int when = 1; when < events; when += events / 4) {
    std::stop_source source;
    int left = when;
    const auto stop = [&](Stage, double) {
      if (--left == 0) source.request_stop();
    };
    try {
      cut_up(merged(pair), {}, {stop, source.get_token()});
      ADD_FAILURE() << "went on after " << when;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
}

TEST(SegmentCharts, TellsProgressThatNeverGoesBackWhereSymmetryIsGivenUp) {
  double last = 0;
  int events = 0;
  const SegmentOptions options{.max_charts = 2, .symmetry = Symmetry::automatic};
  cut_up(sphere(2), options,
         {[&](Stage, double share) {
            EXPECT_GE(share, last);
            last = share;
            ++events;
          },
          {}});
  EXPECT_GT(events, 10);
}

TEST(SegmentCharts, CutsAlongGivenPathsAndNamesThePathThatLeavesTheMesh) {
  const Surface tube = surface_of(cylinder(12, 4));
  SeamPath along{.surface = 0, .vertices = {}};
  for (Index row = 0; row <= 4; ++row) along.vertices.push_back(12 * row);
  const std::vector<SeamPath> paths{along};
  const charts::Charts opened = charts::components_of(tube, {SeamMode::automatic, paths, 0});
  ASSERT_EQ(opened.charts.size(), 1U);
  EXPECT_EQ(opened.charts[0].loops.size(), 1U);
  EXPECT_EQ(charts::components_of(tube, {SeamMode::automatic, paths, 1}).charts[0].loops.size(),
            2U);
  for (const Index stray : {Index(18), Index(-1), Index(99)}) {
    const std::vector<SeamPath> wrong{along, {0, {0, stray}}};
    try {
      charts::components_of(tube, {SeamMode::automatic, wrong, 0});
      ADD_FAILURE() << stray;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_option);
      EXPECT_EQ(e.where(), "/seam_edges/1");
    }
  }
}

TEST(SegmentCharts, CutsWhereTheUvsThatCameInHaveTheirSeams) {
  Surface box = surface_of(cube(0));  // two faces a side, each side in a place of its own
  for (std::size_t t = 0; t < box.mesh.faces.size(); ++t) {
    const auto place = double(t / 2);
    CornerUv uv;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = box.mesh.positions[std::size_t(box.mesh.faces[t][i])];
      uv[i] = Vec2(p.x() + 2 * p.z() + 10 * place, p.y() + 3 * p.z());
    }
    box.corner_uv.push_back(uv);
  }
  const charts::Charts sides = charts::components_of(box, {.mode = SeamMode::uv0});
  EXPECT_EQ(sides.charts.size(), 6U);
  for (const charts::Chart& side : sides.charts) EXPECT_EQ(side.mesh.face_count(), 2);
  EXPECT_EQ(charts::components_of(box, {.mode = SeamMode::automatic}).charts.size(), 1U);
}

/// A band along three quarters of a circle, rolled up: it lies flat without distortion, and leaves
/// a page empty.
TriMesh rolled_arc() {
  constexpr double kRoll = 0.4;
  return mapped_grid(48, 2, Wrap::none, [](double u, double v) {
    const double angle = 1.5 * std::numbers::pi * u, radius = 1 - 0.1 * v;
    const double around = radius * std::cos(angle) / kRoll;
    return Vec3(kRoll * std::sin(around), radius * std::sin(angle), kRoll * std::cos(around));
  });
}

TEST(SegmentCharts, LeavesWholeWhatLiesFlatHoweverEmptyThePage) {
  const Cut cut = cut_up(rolled_arc(), {.max_distortion = 2.02});
  EXPECT_EQ(cut.surfaces.front().charts.size(), 1U);
  expect_sound(cut, std::size_t(rolled_arc().face_count()));
}

}  // namespace
}  // namespace unwrapd::segment
