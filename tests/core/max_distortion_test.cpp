// The bound on distortion, and what it costs in seams.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "core/segment/chart_excess.hpp"
#include "core/segment/large_charts.hpp"
#include "core/segment/segment_charts.hpp"
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
  for (const Effort effort : {Effort::fast, Effort::balanced}) {
    double last = std::numeric_limits<double>::infinity();
    for (const double bound : {2.02, 2.1}) {
      const UnwrapOptions options{.max_distortion = bound, .effort = effort};
      const Report report = unwrap(std::vector{surface}, options, {}, serial).report;
      EXPECT_LE(report.distortion.angle, bound);
      EXPECT_LE(report.distortion.area, bound);
      EXPECT_LE(report.seam_length, last * (1 + 1e-9)) << bound;
      last = report.seam_length;
    }
  }
}

/// The borders of all charts.
double border_of(std::span<const charts::Chart> charts) {
  double length = 0;
  for (const charts::Chart& chart : charts) {
    const auto at = [&](Index h, Index i) {
      return chart.mesh.positions[std::size_t(chart.mesh.faces[std::size_t(h / 3)][(h + i) % 3])];
    };
    for (const BoundaryLoop& loop : chart.loops)
      for (const Index h : loop) length += (at(h, 1) - at(h, 0)).norm();
  }
  return length;
}

/// Here searches of their own for 2.002 are luckier than those for 2.005.
TEST(MaxDistortion, HasNoLongerSeamsBelowTheDefaultEither) {
  SerialExecutor serial;
  for (const auto& [seed, effort] :
       {std::pair{1U, Effort::balanced}, {6U, Effort::balanced}, {6U, Effort::fast}}) {
    const Surface surface = shapes::surface_of(shapes::random_disk(16, seed));
    double last = std::numeric_limits<double>::infinity();
    for (const double bound : {2.0005, 2.002, 2.005, 2.01, 2.02}) {
      std::vector<charts::Charts> cut{charts::components_of(surface, {})};
      segment::segment_charts(cut, {.max_distortion = bound, .effort = effort}, {}, serial);
      EXPECT_LE(segment::chart_excess(cut[0].charts, serial, {}).mean.worst(), bound - 2);
      EXPECT_LE(border_of(cut[0].charts), last * (1 + 1e-9)) << seed << ' ' << bound;
      last = border_of(cut[0].charts);
    }
  }
}

/// A small one, found by the way of large ones.
TEST(MaxDistortion, HasNoLongerSeamsOnLargeSurfacesEither) {
  SerialExecutor serial;
  const charts::Charts whole =
      charts::components_of(shapes::surface_of(bent(shapes::cube(2), 3)), {});
  double last = std::numeric_limits<double>::infinity();
  for (const double bound : {2.02, 2.03, 2.07}) {
    segment::SegmentRules rules;
    rules.max_distortion = bound;
    const double border = border_of(
        segment::large_charts(whole.charts.front(), rules, {.faces = 12000}, serial).charts);
    EXPECT_LE(border, last * (1 + 1e-9)) << bound;
    last = border;
  }
}

/// Several pieces share out what charts are allowed: one each, too few.
TEST(MaxDistortion, HasNoLongerSeamsWithFewChartsEither) {
  SerialExecutor serial;
  std::vector<TriMesh> pieces;
  for (unsigned k = 0; k < 2; ++k)
    pieces.push_back(shapes::moved(bent(shapes::cube(1), k), {5.0 * k, 0, 0}));
  const Surface surface = shapes::surface_of(shapes::merged(pieces));
  for (const int most : {2, 3}) {
    double last = std::numeric_limits<double>::infinity();
    for (const double bound : {2.005, 2.02, 2.2}) {
      std::vector<charts::Charts> surfaces{charts::components_of(surface, {})};
      segment::segment_charts(surfaces, {.max_distortion = bound, .max_charts = most}, {}, serial);
      EXPECT_LE(int(surfaces[0].charts.size()), most);
      const double border = border_of(surfaces[0].charts);
      EXPECT_LE(border, last * (1 + 1e-9)) << most << ' ' << bound;
      last = border;
    }
  }
}

}  // namespace
}  // namespace unwrapd
