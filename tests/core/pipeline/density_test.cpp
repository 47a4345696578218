// Charts that are painted to have more texels. Their scale is measured from the UVs of the result.
#include "core/pipeline/density.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

#include "core/pipeline/layout.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

/// Two boxes, of which the second has this value.
Surface two_boxes(double value) {
  TriMesh other = cube(2);
  for (Vec3& p : other.positions) p = 0.7 * p + Vec3(3, 0, 0);
  Surface surface = surface_of(merged(std::vector<TriMesh>{cube(2), other}));
  for (const Vec3& p : surface.mesh.positions)
    surface.texel_density.push_back(p.x() > 2 ? value : 0);
  return surface;
}

Unwrapped unwrap_densely(const Surface& surface, const UnwrapOptions& options = {}) {
  SerialExecutor serial;
  return unwrap(std::span(&surface, 1), options, {}, serial);
}

/// Texels for each unit of length on the faces of one box.
double density_on(const Unwrapped& result, const Surface& surface, bool of_second) {
  double in_space = 0, on_page = 0;
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t) {
    const auto p = [&](std::size_t i) -> const Vec3& {
      return surface.mesh.positions[std::size_t(surface.mesh.faces[t][i])];
    };
    const auto u = [&](std::size_t i) -> const Vec2& {
      return result.surfaces[0].uv[std::size_t(result.surfaces[0].faces[t][i])];
    };
    if ((p(0).x() > 2) != of_second) continue;
    in_space += (p(1) - p(0)).cross(p(2) - p(0)).norm();
    const Vec2 a = u(1) - u(0), b = u(2) - u(0);
    on_page += std::abs(a.x() * b.y() - a.y() * b.x());
  }
  return result.report.page.width * std::sqrt(on_page / in_space);
}

TEST(PaintedDensity, GivesUpToFourTimesTheTexelsForEachUnit) {
  for (const double value : {0.0, 0.25, 0.5, 1.0}) {
    const Surface surface = two_boxes(value);
    const Unwrapped result = unwrap_densely(surface);
    const double ratio = density_on(result, surface, true) / density_on(result, surface, false);
    EXPECT_NEAR(ratio, std::pow(4, value), 1e-3 * ratio) << value;
  }
}

TEST(PaintedDensity, IsNoDistortionAndInTheTexelDensity) {
  const Surface surface = two_boxes(1);
  Surface bare = surface;
  bare.texel_density.clear();
  const Report painted = unwrap_densely(surface).report, plain = unwrap_densely(bare).report;
  EXPECT_NEAR(painted.distortion.angle, plain.distortion.angle, 1e-4);
  EXPECT_NEAR(painted.distortion.area, plain.distortion.area, 1e-4);
  EXPECT_LT(painted.distortion.area, 2.02);
  double area = 0, texels = 0;
  const Unwrapped result = unwrap_densely(surface);
  for (const bool of_second : {false, true}) {
    const double own = of_second ? 0.49 : 1;
    area += own;
    texels += own * std::pow(density_on(result, surface, of_second), 2);
  }
  EXPECT_NEAR(painted.texel_density, std::sqrt(texels / area), 1e-3 * painted.texel_density);
}

TEST(PaintedDensity, LeavesWhatIsNotPaintedAtTheDensityThatWasAskedFor) {
  UnwrapOptions options{.page_fit = PageFit::multiple_of_four};
  options.packing.texels_per_unit = 50;
  const Surface surface = two_boxes(1);
  const Unwrapped result = unwrap_densely(surface, options);
  EXPECT_NEAR(density_on(result, surface, false), 50, 0.1);
  EXPECT_NEAR(density_on(result, surface, true), 200, 0.4);
}

TEST(PaintedDensity, ChangesNothingWhereItIsZeroOrConstraintsDecide) {
  const Surface zero = two_boxes(0);
  Surface bare = zero;
  bare.texel_density.clear();
  EXPECT_EQ(unwrap_densely(zero).surfaces[0].uv, unwrap_densely(bare).surfaces[0].uv);
  const Surface one = two_boxes(1);
  UnwrapOptions held;
  held.constraints = {{.surface = 0, .vertex = 0, .uv = Vec2(0.2, 0.2)},
                      {.surface = 0, .vertex = bare.mesh.vertex_count() - 1, .uv = Vec2(0.7, 0.6)}};
  EXPECT_EQ(unwrap_densely(one, held).surfaces[0].uv, unwrap_densely(bare, held).surfaces[0].uv);
}

TEST(PaintedDensity, GoesByTheMeanOverAChartsArea) {
  const TriMesh sheet = grid(2, 1, 3, 1);  // quads of equal size
  Surface surface = surface_of(sheet);
  for (const Vec3& p : sheet.positions) surface.texel_density.push_back(p.x() / 3);
  const charts::Charts charts = charts::components_of(surface, {});
  EXPECT_NEAR(pipeline::density_of(charts.charts.front(), surface, {}), 2, 1e-12);
}

/// Two boxes of their own, of which the scene shows the second at this scale.
std::vector<Surface> scene(double scale) {
  std::vector<Surface> surfaces = {surface_of(cube(2)), surface_of(cube(2))};
  for (Vec3& p : surfaces[1].mesh.positions) p *= 0.7;
  surfaces[1].scale = scale;
  return surfaces;
}

/// The same boxes as the scene shows them.
std::vector<Surface> as_shown(std::vector<Surface> surfaces) {
  for (Surface& surface : surfaces) {
    for (Vec3& p : surface.mesh.positions) p *= surface.scale;
    surface.scale = 1;
  }
  return surfaces;
}

/// The report of the scene is that of the boxes as it shows them. The scale is a power of two, so
/// that nothing is rounded.
void expect_as_shown(UnwrapOptions options) {
  SerialExecutor serial;
  std::vector<Surface> small = scene(8);
  if (options.keeps_uvs())
    for (Surface& surface : small)
      for (const Triangle& face : surface.mesh.faces) {
        CornerUv& uv = surface.corner_uv.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
          uv[k] = surface.mesh.positions[std::size_t(face[k])].head<2>() +
                  Vec2::Constant(surface.mesh.positions[std::size_t(face[k])].z() / 3);
      }
  const std::vector<Surface> shown = as_shown(small);
  const Unwrapped own = unwrap(small, options, {}, serial);
  const Unwrapped other = unwrap(shown, options, {}, serial);
  for (std::size_t s = 0; s < 2; ++s) EXPECT_EQ(own.surfaces[s].uv, other.surfaces[s].uv);
  EXPECT_DOUBLE_EQ(own.report.texel_density, other.report.texel_density);
  EXPECT_DOUBLE_EQ(own.report.area, other.report.area);
  EXPECT_DOUBLE_EQ(own.report.seam_length, other.report.seam_length);
  EXPECT_DOUBLE_EQ(own.report.seam_ratio, other.report.seam_ratio);
  EXPECT_DOUBLE_EQ(own.report.distortion.angle, other.report.distortion.angle);
  EXPECT_DOUBLE_EQ(own.report.distortion.area, other.report.distortion.area);
  EXPECT_DOUBLE_EQ(own.report.distortion.stretch, other.report.distortion.stretch);
  ASSERT_EQ(own.report.charts.size(), other.report.charts.size());
  for (std::size_t k = 0; k < own.report.charts.size(); ++k) {
    EXPECT_DOUBLE_EQ(own.report.charts[k].area, other.report.charts[k].area);
    EXPECT_DOUBLE_EQ(own.report.charts[k].seam_length, other.report.charts[k].seam_length);
  }
}

TEST(SceneScale, CountsAsIfTheMeshHadIt) {
  expect_as_shown({.max_distortion = 2.02});
  UnwrapOptions at_density{.max_distortion = 2.02, .page_fit = PageFit::multiple_of_four};
  at_density.packing.texels_per_unit = 40;
  expect_as_shown(at_density);
}

/// Borders decide between the charts of two bounds.
TEST(SceneScale, CountsForBorders) {
  const auto borders = [](const std::vector<Surface>& surfaces) {
    SerialExecutor serial;
    const auto all = pipeline::prepare_charts(surfaces, {.max_distortion = 2.02}, {}, serial).all;
    pipeline::Layout layout = pipeline::empty_layouts(all, 1).front();
    for (std::size_t s = 0; s < surfaces.size(); ++s)
      for (const charts::Chart& chart : all->surfaces[s].charts)
        layout.charts[s].emplace_back(all, &chart);
    return std::pair(pipeline::border_of(*all), pipeline::border_of(layout));
  };
  const auto small = borders(scene(8)), shown = borders(as_shown(scene(8)));
  EXPECT_GT(shown.first, 0);
  EXPECT_DOUBLE_EQ(small.first, shown.first);
  EXPECT_DOUBLE_EQ(small.second, shown.second);
}

TEST(SceneScale, CountsWhereUvsAreKept) {
  expect_as_shown({.repack_only = true});
  expect_as_shown({.measure_only = true});
  UnwrapOptions at_density{.page_fit = PageFit::multiple_of_four, .repack_only = true};
  at_density.packing.texels_per_unit = 40;
  expect_as_shown(at_density);
}

}  // namespace
}  // namespace unwrapd
