#include "core/pipeline/settle_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/overlaps.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::pipeline {
namespace {

template <class Place>
MappedChart mapped(const TriMesh& mesh, Place place) {
  charts::Charts all = charts::components_of(shapes::surface_of(mesh), {});
  MappedChart part;
  part.chart = std::make_shared<const charts::Chart>(std::move(all.charts.front()));
  for (const Vec3& p : part.chart->mesh.positions) part.uv.push_back(place(p));
  part.report.mending.parts = 2;
  return part;
}

/// The shadow of a mesh, drawn out along u; its area stays.
MappedChart shadow(const TriMesh& mesh, double stretch) {
  return mapped(mesh, [&](const Vec3& p) { return Vec2(p.x() * stretch, p.y() / stretch); });
}

double worst_of(const MappedChart& part) {
  SerialExecutor serial;
  const Distortion d =
      measure::distortion(measure::distortion_sums(part.chart->mesh, part.uv, serial));
  return std::max(d.angle, d.area);
}

UnwrapOptions without_overlaps() {
  UnwrapOptions options;
  options.guarantee = Guarantee::bijective;
  return options;
}

void settle(std::vector<MappedChart>& parts) {
  SerialExecutor serial;
  settle_parts(without_overlaps(), 0, {}, serial, parts);
}

TEST(SettleParts, SolvesASmallPartThatGaveWay) {
  std::vector<MappedChart> parts{shadow(shapes::grid(30, 30), 1.1),
                                 shadow(shapes::grid(3, 3, .1, .1), 5)};
  const UvMap large = parts[0].uv;
  settle(parts);
  EXPECT_EQ(parts[0].uv, large) << "it has what most have";
  EXPECT_NEAR(worst_of(parts[1]), 2, 1e-6) << "it is flat";
  EXPECT_EQ(parts[1].report.mending.parts, 2) << "of the chart that it is a part of";
}

TEST(SettleParts, LeavesAChartThatIsWhole) {
  std::vector<MappedChart> whole{shadow(shapes::grid(3, 3), 5)};
  const UvMap before = whole[0].uv;
  settle(whole);
  EXPECT_EQ(whole[0].uv, before);
}

/// Flat, but wound up by more than a turn: its best map overlaps itself.
TEST(SettleParts, LeavesAPartThatWouldLoseTheGuarantee) {
  const TriMesh spiral = shapes::mapped_grid(60, 2, shapes::Wrap::none, [](double u, double v) {
    return Vec3((2 - v) * std::cos(8 * u), (2 - v) * std::sin(8 * u), 0.5 * u);
  });
  const auto less_wound = [](const Vec3& p) {
    const double angle = 6 * p.z();
    return Vec2(std::hypot(p.x(), p.y()) * Vec2(std::cos(angle), std::sin(angle)));
  };
  std::vector<MappedChart> parts{shadow(shapes::grid(30, 30, 20, 20), 1),
                                 mapped(spiral, less_wound)};
  const auto overlaps = [&] {
    return measure::overlapping_pairs(parts[1].chart->mesh.faces, parts[1].uv, 1).size();
  };
  ASSERT_EQ(overlaps(), 0U);
  settle(parts);
  EXPECT_EQ(overlaps(), 0U);
  EXPECT_EQ(parts[1].chart->mesh.face_count(), spiral.face_count());
}

TEST(SettleParts, EndsAtOnceWhenCancelled) {
  std::vector<MappedChart> parts{shadow(shapes::grid(30, 30), 1),
                                 shadow(shapes::grid(3, 3, .1, .1), 5)};
  std::stop_source stop;
  stop.request_stop();
  SerialExecutor serial;
  EXPECT_THROW(settle_parts(without_overlaps(), 0, stop.get_token(), serial, parts), Error);
}

}  // namespace
}  // namespace unwrapd::pipeline
