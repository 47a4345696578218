// The bound on distortion, and what it costs in seams.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

/// A shape drawn out of shape along a few waves, and roughened a little.
TriMesh bent(TriMesh mesh, unsigned seed) {
  std::mt19937 rng(seed);
  const auto draw = [&] { return double(rng() % 100001) / 50000 - 1; };
  const auto draw_vector = [&](double most) {
    const double x = draw(), y = draw(), z = draw();
    return Vec3(most * Vec3(x, y, z));
  };
  std::array<Vec3, 4> wave, depth;
  std::array<double, 4> phase{};
  for (std::size_t i = 0; i < 4; ++i)
    wave[i] = draw_vector(2.5), depth[i] = draw_vector(0.35), phase[i] = 3 * draw();
  const Vec3 scale = Vec3::Ones() + draw_vector(0.5);
  double reach = 0;
  for (const Vec3& p : mesh.positions) reach = std::max(reach, p.norm());
  for (Vec3& p : mesh.positions) {
    const Vec3 q = p / reach;
    p = q.cwiseProduct(scale) + draw_vector(0.02);
    for (std::size_t i = 0; i < 4; ++i) p += depth[i] * std::sin(wave[i].dot(q) + phase[i]);
  }
  return mesh;
}

TEST(MaxDistortion, HasNoLongerSeamsWhereItIsLooser) {
  const Surface surface = shapes::surface_of(bent(shapes::cube(2), 2));
  SerialExecutor serial;
  double last = std::numeric_limits<double>::infinity();
  for (const double bound : {2.02, 2.1}) {
    const Report report =
        unwrap(std::vector{surface}, {.max_distortion = bound}, {}, serial).report;
    EXPECT_LE(report.distortion.angle, bound);
    EXPECT_LE(report.distortion.area, bound);
    EXPECT_LE(report.seam_length, last * (1 + 1e-9)) << bound;
    last = report.seam_length;
  }
}

}  // namespace
}  // namespace unwrapd
