// Small parts beside large ones, as a bolt on a terrain.
#include "core/pipeline/enlarge_tiny_islands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

/// A plate, and a shape that is scaled by `ratio` beside it.
Surface beside_a_plate(TriMesh shape, double ratio) {
  for (Vec3& p : shape.positions) p *= ratio;
  return surface_of(merged(std::vector<TriMesh>{grid(8, 8), moved(shape, {2, 0, 0})}));
}

Unwrapped unwrapped(const Surface& surface, double max_distortion) {
  SerialExecutor serial;
  UnwrapOptions options;
  options.max_distortion = max_distortion;
  options.guarantee = Guarantee::bijective;
  return unwrap(std::span(&surface, 1), options, {}, serial);
}

double longer_side(const Unwrapped& result, std::size_t first_face) {
  Vec2 low = Vec2::Constant(2), high = -low;
  for (std::size_t t = first_face; t < result.surfaces[0].faces.size(); ++t)
    for (const Index v : result.surfaces[0].faces[t]) {
      low = low.cwiseMin(result.surfaces[0].uv[std::size_t(v)]);
      high = high.cwiseMax(result.surfaces[0].uv[std::size_t(v)]);
    }
  return (high - low).maxCoeff();
}

/// Positions are near the origin, so that only UVs lose precision.
TEST(EnlargeTinyIslands, LetsSmallPartsKeepTheirMaps) {
  for (const double ratio : {1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    for (const TriMesh& shape : {grid(4, 4), half_cylinder(16, 4), cube(2)}) {
      SCOPED_TRACE(ratio);
      const Unwrapped result = unwrapped(beside_a_plate(shape, ratio), 2.02);
      EXPECT_EQ(result.report.overlaps, 0);
      for (const ChartReport& chart : result.report.charts) {
        EXPECT_LE(chart.distortion.angle, 2.08);
        EXPECT_LE(chart.distortion.area, 2.08);
      }
      for (const Vec2& uv : result.surfaces[0].uv) {
        EXPECT_GE(uv.minCoeff(), 0);
        EXPECT_LE(uv.maxCoeff(), 1);
      }
    }
  }
}

/// What has some steps stays as large as it is beside others; what has none has a few texels.
TEST(EnlargeTinyIslands, ChangesTheSizeOfTinyOnesAlone) {
  const std::size_t of_plate = grid(8, 8).faces.size();
  const Unwrapped small = unwrapped(beside_a_plate(grid(4, 4), 1e-3), 2.02);
  EXPECT_NEAR(longer_side(small, of_plate) / longer_side(small, 0), 1e-3, 1e-3);
  const Unwrapped tiny = unwrapped(beside_a_plate(grid(4, 4), 1e-8), 2.02);
  EXPECT_GT(longer_side(tiny, of_plate), 0x1p-15);
  EXPECT_LT(longer_side(tiny, of_plate), 0x1p-12);
}

}  // namespace
}  // namespace unwrapd
