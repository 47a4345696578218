// A texture that is not square through the front door: figures count in texels, promises hold of
// what is written.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "tests/core/shapes.hpp"
#include "tests/core/unwrapped_surface.hpp"

namespace unwrapd::pipeline {
namespace {

UnwrapOptions on_page(int width, int height) {
  return {.width = width, .height = height, .guarantee = Guarantee::bijective};
}

double area_of(const Surface& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.mesh.faces) {
    const auto& p = surface.mesh.positions;
    area += (p[b] - p[a]).cross(p[c] - p[a]).norm() / 2;
  }
  return area;
}

double texels_of(const UnwrappedSurface& s, const PageSize& page) {
  double twice = 0;
  for (const auto& [a, b, c] : s.faces) {
    const Vec2 p = s.uv[b] - s.uv[a], q = s.uv[c] - s.uv[a];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2 * page.width * page.height;
}

/// The greatest difference between an edge's length in texels and in space, times the density.
double most_stretched(const Surface& surface, const Unwrapped& u, const PageSize& page) {
  const UnwrappedSurface& s = u.surfaces[0];
  double most = 0;
  for (std::size_t t = 0; t < s.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = s.faces[t][i], b = s.faces[t][(i + 1) % 3];
      const Vec2 on_page = (s.uv[b] - s.uv[a]).cwiseProduct(Vec2(page.width, page.height));
      const Vec3 in_space =
          surface.mesh.positions[s.source[b]] - surface.mesh.positions[s.source[a]];
      const double wanted = in_space.norm() * u.report.texel_density;
      most = std::max(most, std::abs(on_page.norm() / wanted - 1));
    }
  return most;
}

class PageSizes : public testing::TestWithParam<PageSize> {};

TEST_P(PageSizes, FlatSurfacesKeepTheirShapesInTexels) {
  const PageSize page = GetParam();
  const Surface sheet = shapes::surface_of(shapes::grid(4, 3, 2, 1));
  const Unwrapped u = unwrapped_surface(sheet, on_page(page.width, page.height));
  EXPECT_LT(most_stretched(sheet, u, page), 1e-4);
  EXPECT_NEAR(u.report.distortion.angle, 2, 1e-6);
  EXPECT_NEAR(u.report.distortion.area, 2, 1e-6);
}

TEST_P(PageSizes, FillDensityAndPromisesAreThoseOfWhatIsWritten) {
  const PageSize page = GetParam();
  const Surface ball = shapes::surface_of(shapes::sphere(2));
  const Unwrapped u = unwrapped_surface(ball, on_page(page.width, page.height));
  const UnwrappedSurface& s = u.surfaces[0];
  const double texels = texels_of(s, page);
  EXPECT_NEAR(u.report.texel_density / std::sqrt(texels / area_of(ball)), 1, 1e-6);
  EXPECT_NEAR(u.report.fill, texels / page.width / page.height, 1e-5);
  EXPECT_TRUE(measure::flipped_faces(s.faces, s.uv).empty());
  EXPECT_TRUE(measure::overlapping_pairs(s.faces, s.uv, 10).empty());
  for (const Vec2& uv : s.uv) {
    EXPECT_GE(uv.minCoeff(), 0);
    EXPECT_LE(uv.maxCoeff(), 1);
    EXPECT_EQ(std::ldexp(uv.y(), 24), std::round(std::ldexp(uv.y(), 24)));
  }
}

TEST_P(PageSizes, ChartsAndTheirDistortionAreThoseOfASquarePage) {
  const PageSize page = GetParam();
  const Surface ball = shapes::surface_of(shapes::sphere(2));
  const Report square = unwrapped_surface(ball, on_page(1024, 1024)).report;
  const Report own = unwrapped_surface(ball, on_page(page.width, page.height)).report;
  ASSERT_EQ(own.charts.size(), square.charts.size());
  EXPECT_NEAR(own.distortion.angle, square.distortion.angle, 1e-4);
  EXPECT_NEAR(own.distortion.area, square.distortion.area, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Pages, PageSizes,
                         testing::Values(PageSize{1024, 512}, PageSize{300, 900},
                                         PageSize{4096, 128}, PageSize{256, 256}));

TEST(PageSize, ConstraintsAreUvs) {
  UnwrapOptions options = on_page(1024, 256);
  options.guarantee = Guarantee::flip_free;
  options.constraints = {{.vertex = 0, .uv = Vec2(0.25, 0.1)}, {.vertex = 4, .uv = Vec2(0.5, 0.1)}};
  const Surface surface = shapes::surface_of(shapes::grid(4, 4));
  const Unwrapped u = unwrapped_surface(surface, options);
  const UnwrappedSurface& s = u.surfaces[0];
  EXPECT_LT((s.uv[0] - Vec2(0.25, 0.1)).norm(), 1e-7);
  EXPECT_LT((s.uv[4] - Vec2(0.5, 0.1)).norm(), 1e-7);
  EXPECT_LT(most_stretched(surface, u, options.page_size()), 1e-3);
  // A square of 256 texels on 1024 x 256, a tenth of it above the page.
  EXPECT_NEAR(u.report.fill, 0.9 * 0.25, 1e-3);
}

TEST(PageSize, RepackingTakesTheUvsForThoseOfSuchATexture) {
  Surface surface = shapes::surface_of(shapes::grid(1, 1));
  for (const Triangle& face : surface.mesh.faces) {
    CornerUv& uv = surface.corner_uv.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      uv[i] = surface.mesh.positions[face[i]].head<2>().cwiseProduct(Vec2(0.2, 0.4));
  }
  UnwrapOptions options{.width = 1024, .height = 512, .padding = 0, .repack_only = true};
  const Unwrapped u = unwrapped_surface(surface, options);  // squares of 205 texels
  EXPECT_NEAR(u.report.distortion.angle, 2, 1e-6);
  EXPECT_NEAR(u.report.fill, 0.5, 1e-4);
  EXPECT_NEAR(texels_of(u.surfaces[0], options.page_size()), 512 * 512, 10);
}

}  // namespace
}  // namespace unwrapd::pipeline
