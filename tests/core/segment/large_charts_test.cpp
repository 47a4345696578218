#include "core/segment/large_charts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/segment/chart_excess.hpp"
#include "core/unwrap.hpp"
#include "tests/bench/noisy_body.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;

Unwrapped unwrapped(const TriMesh& mesh) {
  TwoThreads two;
  const std::vector<Surface> surfaces{surface_of(mesh)};
  return unwrap(surfaces, {}, {}, two);
}

long notes_on_the_bound(const Report& report) {
  return std::ranges::count(report.notes, NoteCode::surface_noisy, &Note::code);
}

TEST(LargeCharts, KeepTheBoundOnTheSurfaceThatWasGiven) {
  const std::vector<NamedMesh> meshes{{"body like a scan", bench::noisy_body(20'000, 0.25)},
                                      {"smooth torus", torus(140, 70)}};
  for (const auto& [name, mesh] : meshes) {
    ASSERT_GT(mesh.face_count(), 18'000);
    const Report report = unwrapped(mesh).report;
    EXPECT_LE(report.distortion.angle, kDefaultDistortion) << name;
    EXPECT_LE(report.distortion.area, kDefaultDistortion) << name;
    EXPECT_LE(report.charts.size(), 20U) << name;
    EXPECT_EQ(notes_on_the_bound(report), 0) << name;
  }
}

TEST(LargeCharts, SaySoWhereNoiseLeavesNoRoomForTheBound) {
  const Report report = unwrapped(bench::noisy_body(20'000, 0.5)).report;
  EXPECT_GT(report.distortion.angle, kDefaultDistortion);
  EXPECT_LE(report.charts.size(), 60U);  // not ever more for a bound that none of them keeps
  EXPECT_EQ(notes_on_the_bound(report), 1);
}

/// A torus with so many waves around it, and half of them around its tube.
TriMesh rippled_torus(Index around, Index along, double waves, double height) {
  TriMesh mesh = torus(around, along);
  for (Index k = 0; k < static_cast<Index>(mesh.positions.size()); ++k) {
    Vec3& at = mesh.positions[static_cast<std::size_t>(k)];
    const Vec3 middle = Vec3(at.x(), at.y(), 0).normalized();  // of the tube, with radius 1
    const Vec3 out = at - middle;
    const double u = std::atan2(at.y(), at.x()), v = std::atan2(at.z(), out.dot(middle));
    at = middle + out * (1 + height * std::sin(waves * u) * std::sin(waves / 2 * v));
  }
  return mesh;
}

TEST(LargeCharts, KeepTheBoundWhereAVerySmallSurfaceHidesTooMuch) {
  const std::vector<Surface> surfaces{surface_of(rippled_torus(160, 80, 36, .05))};
  UnwrapOptions options;
  options.effort = Effort::fast;
  SerialExecutor serial;
  const Report report = unwrap(surfaces, options, {}, serial).report;
  EXPECT_LE(report.distortion.angle, kDefaultDistortion);
  EXPECT_LE(report.distortion.area, kDefaultDistortion);
  EXPECT_EQ(notes_on_the_bound(report), 0);
}

/// Small cones on a plate: the small surface shows less of them than there is.
TriMesh plate_with_cones(Index sides, int cones, double radius, double height) {
  return mapped_grid(sides, sides, Wrap::none, [&](double u, double v) {
    const auto off_middle = [&](double x) { return x - (std::floor(x * cones) + 0.5) / cones; };
    const double away = std::hypot(off_middle(u), off_middle(v));
    return Vec3(u, v, height * std::max(0.0, 1 - away / radius));
  });
}

TEST(LargeCharts, AreNoneBeyondWhatOneOfThemMayHave) {
  SerialExecutor serial;
  SegmentRules rules;
  rules.effort = Effort::fast;
  for (const auto& [radius, faces] : {std::pair{.05, 416}, {.05, 625}, {.08, 625}}) {
    const TriMesh mesh = plate_with_cones(50, 2, radius, 3.5 * radius);
    const charts::Charts whole = charts::components_of(surface_of(mesh), {});
    const LargeCharts found = large_charts(whole.charts.front(), rules, {.faces = faces}, serial);
    EXPECT_FALSE(found.is_rough);
    const ChartExcess excess = chart_excess(found.charts, serial, {});
    EXPECT_LE(excess.mean.worst(), kDefaultDistortion - 2);
    EXPECT_LE(std::ranges::max(excess.of_each), kMostOfOneRegion * (kDefaultDistortion - 2));
  }
}

TEST(LargeCharts, AreTheSameForAnyExecutor) {
  const charts::Charts whole =
      charts::components_of(surface_of(bench::noisy_body(12'000, 0.25)), {});
  SerialExecutor serial;
  TwoThreads two;
  const auto one = large_charts(whole.charts.front(), {}, {.faces = 7000}, serial).charts;
  const auto other = large_charts(whole.charts.front(), {}, {.faces = 7000}, two).charts;
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].face_source, other[k].face_source);
    EXPECT_EQ(one[k].start, other[k].start);
  }
}

TEST(LargeCharts, OfASmallerStandInCountOnlyWhereTheyKeepTheBound) {
  SerialExecutor serial;
  const auto of = [&](const TriMesh& mesh) {
    const charts::Charts whole = charts::components_of(surface_of(mesh), {});
    return large_charts_within_bound(whole.charts.front(), {}, 3000, serial);
  };
  const auto smooth = of(torus(100, 50));
  ASSERT_TRUE(smooth);
  EXPECT_LE(chart_excess(*smooth, serial, {}).mean.worst(), kDefaultDistortion - 2);
  EXPECT_FALSE(of(bench::noisy_body(10'000, 0.5)));
}

/// A disk that begins with its shadow.
charts::Chart chart_of(const TriMesh& mesh) {
  charts::Chart chart = std::move(charts::components_of(surface_of(mesh), {}).charts.front());
  for (const Vec3& p : chart.mesh.positions) chart.start.emplace_back(p.x(), p.y());
  return chart;
}

TEST(ChartExcess, IsNoneOfWhatLiesFlatAndThatOfTheSolvedMapElse) {
  SerialExecutor serial;
  const std::vector<charts::Chart> flat{chart_of(grid(20, 20))};
  EXPECT_NEAR(chart_excess(flat, serial, {}).mean.worst(), 0, 1e-9);
  const TriMesh bowl = mapped_grid(30, 30, Wrap::none, [](double u, double v) {
    return Vec3(3 * u, 3 * v, 4 * (u - u * u + v - v * v));
  });
  const std::vector<charts::Chart> charts{chart_of(bowl)};
  const ExcessDistortion excess = chart_excess(charts, serial, {}).mean;
  const Distortion solved = unwrapped(bowl).report.distortion;
  EXPECT_NEAR(excess.angle, solved.angle - 2, 0.05 * (solved.angle - 2));
  EXPECT_NEAR(excess.area, solved.area - 2, 0.05 * (solved.area - 2));
}

}  // namespace
}  // namespace unwrapd::segment
