// Meshes whose vertices lie on a line or a point, or nearly so: whatever is answered, each number
// of the report means something, and what cannot be measured is counted apart.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/hard_shapes.hpp"

namespace unwrapd {
namespace {

constexpr std::array kAllMethods{Method::asap, Method::arap,   Method::hybrid,
                                 Method::abf,  Method::linabf, Method::cp,
                                 Method::bff,  Method::ic,     Method::slim};

constexpr Stop kShort{.max_iterations = 50};

/// No mean can be worse: singular values count as a millionth of the mean stretch at least.
constexpr double kWorstRatio = 1e7, kWorstArea = 1e13;

void expect_within(const char* name, double value, double least, double most) {
  EXPECT_TRUE(value >= least && value <= most) << name << " is " << value;
}

void expect_sensible(const Distortion& distortion, Index faces) {
  expect_within("angle", distortion.angle, 2, kWorstRatio);
  expect_within("area", distortion.area, 2, kWorstArea);
  expect_within("stretch", distortion.stretch, 1 - 1e-9, kWorstRatio);
  expect_within("flipped", distortion.flipped, 0, faces);
  expect_within("degenerate", distortion.degenerate, 0, faces);
}

void expect_sensible(const Report& report) {
  constexpr double kGreatest = std::numeric_limits<double>::max();
  expect_sensible(report.distortion, report.input.faces);
  expect_within("surface area", report.area, 0, kGreatest);
  expect_within("seam length", report.seam_length, 0, kGreatest);
  expect_within("seam ratio", report.seam_ratio, 0, 1e15);
  expect_within("fill", report.fill, 0, 1);
  expect_within("texel density", report.texel_density, 0, kGreatest);
  for (const ChartReport& chart : report.charts) {
    expect_sensible(chart.distortion, chart.faces);
    expect_within("chart's area", chart.area, 0, kGreatest);
    expect_within("chart's seam length", chart.seam_length, 0, kGreatest);
    expect_within("rise of the energy", chart.mending.energy_rise, -1, 1e30);
    for (const double energy : chart.energy) expect_within("energy", energy, 0, 1e30);
  }
}

/// A grid of 3 by 3 squares along (1, 3, 7) / 8, drawn out and off the line by these shares.
TriMesh on_a_line(double length, double width) {
  TriMesh mesh = shapes::grid(3, 3);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (Vec3& p : mesh.positions) {
    const Vec3 off(any(random), any(random), any(random));
    p = length * any(random) * Vec3(.125, .375, .875) + width * off;
  }
  return mesh;
}

std::vector<shapes::NamedMesh> degenerate_families() {
  std::vector<shapes::NamedMesh> all{{"a line", on_a_line(1, 0)},
                                     {"a line of rounded points", on_a_line(1.0 / 3, 0)},
                                     {"a point", on_a_line(0, 0)}};
  for (const double width : {1e-3, 1e-5, 1e-9, 1e-15})
    all.push_back({"a line of width " + std::to_string(width), on_a_line(1, width)});
  TriMesh squeezed = shapes::random_disk(3, 3);
  for (Vec3& p : squeezed.positions) p.y() *= 1e-8, p.z() *= 1e-8;
  all.push_back({"a disk squeezed to a line", squeezed});
  return all;
}

TriMesh at_scale(TriMesh mesh, double scale) {
  for (Vec3& p : mesh.positions) p *= scale;
  return mesh;
}

void expect_sensible_or_refused(const TriMesh& mesh, const UnwrapOptions& options) {
  SerialExecutor serial;
  try {
    expect_sensible(unwrap(std::vector{shapes::surface_of(mesh)}, options, {}, serial).report);
  } catch (const Error& e) {
    EXPECT_TRUE(e.code() == ErrorCode::zero_area || e.code() == ErrorCode::solver_failed ||
                e.code() == ErrorCode::guarantee_failed)
        << e.what();
  }
}

void expect_of_all_families(double scale, const UnwrapOptions& options) {
  for (const shapes::NamedMesh& family : degenerate_families()) {
    SCOPED_TRACE(family.name + ", method " + std::to_string(static_cast<int>(options.method)) +
                 ", guarantee " + std::to_string(static_cast<int>(options.guarantee)));
    expect_sensible_or_refused(at_scale(family.mesh, scale), options);
  }
}

class DegenerateReport : public testing::TestWithParam<double> {};

TEST_P(DegenerateReport, HasSensibleNumbersByEveryMethod) {
  for (const Method method : kAllMethods)
    expect_of_all_families(GetParam(),
                           {.method = method, .stop = kShort, .guarantee = Guarantee::none});
}

INSTANTIATE_TEST_SUITE_P(Scales, DegenerateReport, testing::Values(1e-30, 1.0, 1e30));

TEST(DegenerateReport, HasSensibleNumbersUnderEveryGuarantee) {
  for (const Guarantee guarantee : {Guarantee::flip_free, Guarantee::bijective})
    for (const Method method : {Method::arap, Method::abf})
      expect_of_all_families(1, {.method = method, .stop = kShort, .guarantee = guarantee});
}

/// The UVs that came in may lie on a line or a point, and faces without area beside others.
TEST(DegenerateReport, HasSensibleNumbersForUvsThatCameIn) {
  const TriMesh mesh = shapes::random_disk(4, 3);
  for (const Vec2& stretch : {Vec2(1, 0), Vec2(1, 1e-9), Vec2(0, 0), Vec2(1, 1)}) {
    SCOPED_TRACE(stretch.transpose());
    Surface surface = shapes::surface_of(mesh);
    surface.mesh.faces.push_back({0, 0, 1});
    surface.part.push_back(0);
    for (const Triangle& face : surface.mesh.faces) {
      CornerUv& uv = surface.corner_uv.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        uv[k] = mesh.positions[std::size_t(face[k])].head<2>().cwiseProduct(stretch);
    }
    SerialExecutor serial;
    const Report report = unwrap(std::vector{surface},
                                 {.guarantee = Guarantee::none, .repack_only = true}, {}, serial)
                              .report;
    expect_sensible(report);
    EXPECT_EQ(report.distortion.degenerate, 1);
  }
}

TEST(DegenerateReport, HasSensibleNumbersBesideAMeshOfAnyOtherSize) {
  SerialExecutor serial;
  for (const double scale : {1e-30, 1e-80, 1e-120, 1e-200}) {
    SCOPED_TRACE(scale);
    const std::vector<Surface> both{shapes::surface_of(shapes::sphere(1)),
                                    shapes::surface_of(at_scale(shapes::sphere(1), scale))};
    try {
      expect_sensible(unwrap(both, {.effort = Effort::fast}, {}, serial).report);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::zero_area) << e.what();
    }
  }
}

}  // namespace
}  // namespace unwrapd
