#include "core/solve/straighten.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/charts/charts.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::solve {
namespace {

/// A sheet of quads whose long sides wave by `wave`, turned by an angle in its plane.
TriMesh sheet(double wave, double angle) {
  return shapes::mapped_grid(24, 4, shapes::Wrap::none, [&](double u, double v) {
    const Vec2 p(6 * u, v + wave * std::sin(9 * u) * (v - 0.5));
    return Vec3(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                std::sin(angle) * p.x() + std::cos(angle) * p.y(), 0);
  });
}

UvMap flat(const TriMesh& mesh) {
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(p.head<2>());
  return uv;
}

std::optional<UvMap> straight(const TriMesh& mesh) {
  const charts::Charts charts = charts::make_charts(shapes::surface_of(mesh), SeamMode::none);
  const charts::Chart& chart = charts.charts.front();
  UvMap uv = flat(chart.mesh);
  return straightened(make_disk(chart.mesh, chart.loops), uv);
}

double area_of(const TriMesh& mesh, const UvMap& uv) {
  double twice = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec2 p = uv[b] - uv[a], q = uv[c] - uv[a];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2;
}

/// Of the rectangle around the map, the share that its triangles fill: 1 for a rectangle.
double share_of_box(const TriMesh& mesh, const UvMap& uv) {
  Vec2 low = uv.front(), high = low;
  for (const Vec2& p : uv) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return area_of(mesh, uv) / (high - low).prod();
}

TEST(Straightened, AWavySheetBecomesARectangleOfItsArea) {
  for (const double angle : {0.0, 0.3, 0.75, 2.0}) {
    const TriMesh mesh = sheet(0.1, angle);
    const charts::Charts charts = charts::make_charts(shapes::surface_of(mesh), SeamMode::none);
    const TriMesh& chart = charts.charts.front().mesh;
    const UvMap uv = flat(chart);
    const auto map = straight(mesh);
    ASSERT_TRUE(map);
    EXPECT_NEAR(share_of_box(chart, *map), 1, 1e-9);
    EXPECT_NEAR(area_of(chart, *map), area_of(chart, uv), 1e-9);
    EXPECT_TRUE(measure::flipped_faces(chart.faces, *map).empty());
  }
}

TEST(Straightened, InnerVerticesFollowTheBoundary) {
  const TriMesh mesh = sheet(0.15, 0);
  const charts::Charts charts = charts::make_charts(shapes::surface_of(mesh), SeamMode::none);
  const charts::Chart& chart = charts.charts.front();
  const Disk disk = make_disk(chart.mesh, chart.loops);
  const auto map = straight(mesh);
  ASSERT_TRUE(map);
  UvMap stiff = flat(chart.mesh);  // the boundary alone moves
  for (const Index h : chart.loops[0]) {
    const auto v = static_cast<std::size_t>(chart.mesh.faces[h / 3][h % 3]);
    stiff[v] = (*map)[v];
  }
  const auto worst = [&](const UvMap& uv) {
    const Distortion own = measure::distortion(measure::distortion_sums(disk.rest, disk.faces, uv));
    return own.angle + own.area;
  };
  EXPECT_LT(worst(*map), worst(stiff) - 1e-3);
}

TEST(Straightened, ARectangleStaysAsItIs) {
  const TriMesh mesh = sheet(0, 0);
  const auto map = straight(mesh);
  ASSERT_TRUE(map);
  const charts::Charts charts = charts::make_charts(shapes::surface_of(mesh), SeamMode::none);
  const UvMap uv = flat(charts.charts.front().mesh);
  for (std::size_t v = 0; v < uv.size(); ++v)
    EXPECT_LT(((*map)[v] - (*map)[0] - uv[v] + uv[0]).norm(), 1e-9);
}

TEST(Straightened, OtherShapesAreLeftAlone) {
  EXPECT_FALSE(straight(shapes::random_disk(3, 3)));
  EXPECT_FALSE(straight(shapes::annulus(12, 3)));
  EXPECT_FALSE(straight(sheet(0.6, 0.2)));  // too wavy
  TriMesh trapezoid = shapes::grid(6, 6);
  for (Vec3& p : trapezoid.positions) p.x() *= 1 + 0.5 * p.y();
  EXPECT_FALSE(straight(trapezoid));
}

TEST(Straightened, ChartsThroughTheFrontDoorKeepTheBoundAndTheGuarantee) {
  const Surface surface = shapes::surface_of(sheet(0.1, 0.4));
  SerialExecutor serial;
  const auto unwrapped = [&](Straighten straighten, double bound) {
    return unwrap(std::span(&surface, 1),
                  {.max_distortion = bound,
                   .guarantee = Guarantee::bijective,
                   .packing = {.rotation = Rotation::quarter},
                   .straighten = straighten},
                  {}, serial);
  };
  const Unwrapped plain = unwrapped(Straighten::off, 2.02),
                  rectangles = unwrapped(Straighten::automatic, 2.02);
  const auto share = [&](const Unwrapped& u) {
    return share_of_box({{}, u.surfaces[0].faces}, u.surfaces[0].uv);
  };
  ASSERT_EQ(plain.report.charts.size(), 1U);
  EXPECT_LT(share(plain), 0.95);
  EXPECT_NEAR(share(rectangles), 1, 1e-4);
  EXPECT_EQ(rectangles.report.distortion.flipped, 0);
  EXPECT_LE(rectangles.report.distortion.angle, 2.02);
  EXPECT_LE(rectangles.report.distortion.area, 2.02);
  EXPECT_GT(rectangles.report.distortion.area, plain.report.distortion.area);
  EXPECT_LT(share(unwrapped(Straighten::automatic, 2.0005)), 0.95);  // the bound forbids it
}

}  // namespace
}  // namespace unwrapd::solve
