// Constraints and boundary shapes through the front door.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

Unwrapped unwrapped(const std::vector<TriMesh>& meshes, const UnwrapOptions& options) {
  std::vector<Surface> surfaces;
  for (const TriMesh& mesh : meshes) surfaces.push_back(shapes::surface_of(mesh));
  SerialExecutor serial;
  return unwrap(surfaces, options, {}, serial);
}

constexpr std::array kMethods{Method::asap, Method::arap, Method::hybrid};

PositionConstraint pin(Index vertex, double u, double v) {
  return {.vertex = vertex, .uv = Vec2(u, v)};
}

double signed_area(const UnwrappedSurface& s) {
  double sum = 0;
  for (const auto& [a, b, c] : s.faces) {
    const Vec2 p = s.uv[std::size_t(b)] - s.uv[std::size_t(a)];
    const Vec2 q = s.uv[std::size_t(c)] - s.uv[std::size_t(a)];
    sum += (p.x() * q.y() - p.y() * q.x()) / 2;
  }
  return sum;
}

/// Half a step of the lattice that UVs are written on: 32-bit floats of [0.5, 1].
constexpr double kHalfStep = 0x1p-25;

/// The nearest point of the lattice that UVs on the page are written on.
Vec2 as_written(const Vec2& uv) {
  constexpr double kStep = 2 * kHalfStep;
  return {std::round(uv.x() / kStep) * kStep, std::round(uv.y() / kStep) * kStep};
}

constexpr std::array kGuarantees{Guarantee::none, Guarantee::flip_free, Guarantee::bijective};

void expect_pins_exact(const TriMesh& mesh, UnwrapOptions options) {
  for (const Method method : kMethods)
    for (const Guarantee guarantee : kGuarantees) {
      options.method = method, options.guarantee = guarantee;
      const Unwrapped u = unwrapped({mesh}, options);
      for (const PositionConstraint& c : options.constraints)
        EXPECT_EQ(u.surfaces[0].uv[std::size_t(*c.vertex)], as_written(c.uv));
    }
}

TEST(ConstrainedUnwrap, WritesHardPinsExactly) {
  const TriMesh mesh = shapes::shuffled(shapes::random_disk(12, 3), 4);
  UnwrapOptions options;
  for (Index v : {5, 60, 90, 141}) {
    const Vec3& p = mesh.positions[std::size_t(v)];
    options.constraints.push_back(pin(v, 0.1 + 0.7 * p.x(), 0.1 + 0.7 * p.y()));
  }
  expect_pins_exact(mesh, options);
}

/// The rest of the chart is written on a coarser lattice.
TEST(ConstrainedUnwrap, WritesHardPinsExactlyThoughTheChartReachesBeyondThePage) {
  const TriMesh mesh = shapes::shuffled(shapes::random_disk(12, 3), 4);
  UnwrapOptions options;
  for (Index v = 0; v < mesh.vertex_count() && options.constraints.size() < 4; ++v) {
    const Vec3& p = mesh.positions[std::size_t(v)];
    if (p.head<2>().maxCoeff() < 0.25)
      options.constraints.push_back(pin(v, 0.1 + 3.3 * p.x(), 0.1 + 3.3 * p.y()));
  }
  ASSERT_GE(options.constraints.size(), 3U);
  expect_pins_exact(mesh, options);
}

TEST(ConstrainedUnwrap, HoldsASheetWhereItIsPut) {
  const TriMesh mesh = shapes::grid(8, 4, 2, 1);
  for (Method method : kMethods) {
    const Unwrapped u = unwrapped(
        {mesh}, {.method = method, .constraints = {pin(0, 0.25, 0.5), pin(8, 0.75, 0.5)}});
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const Vec2 wanted = Vec2(0.25, 0.5) + mesh.positions[std::size_t(v)].head<2>() / 4;
      EXPECT_LT((u.surfaces[0].uv[std::size_t(v)] - wanted).norm(), 1e-6);
    }
    EXPECT_NEAR(u.report.fill, 0.125, 1e-6);
    EXPECT_NEAR(u.report.texel_density, 256, 1e-3);
    EXPECT_NEAR(u.report.distortion.area, 2, 1e-6);
  }
}

TEST(ConstrainedUnwrap, HoldsByPositionAsByIndex) {
  const TriMesh mesh = shapes::random_disk(9, 3);
  UnwrapOptions by_index, by_place;
  for (Index v : {0, 9, 99, 44}) {
    const Vec3& p = mesh.positions[std::size_t(v)];
    by_index.constraints.push_back(pin(v, p.x(), p.y()));
    by_place.constraints.push_back(
        {.position = p + Vec3(0, 0, 1e-3), .uv = p.head<2>(), .weight = 1e9});
    by_index.constraints.back().weight = 1e9;
  }
  EXPECT_EQ(unwrapped({mesh}, by_index).surfaces[0].uv, unwrapped({mesh}, by_place).surfaces[0].uv);
}

TEST(ConstrainedUnwrap, ReportsTheDistortionOfChartsAtTheirOwnScales) {
  PositionConstraint small = pin(0, 0, 0), wide = pin(3, 0.1, 0);
  small.surface = wide.surface = 1;
  const Unwrapped u = unwrapped({shapes::grid(3, 3), shapes::grid(3, 3)},
                                {.constraints = {pin(0, 0.4, 0.4), pin(3, 0.6, 0.4), small, wide}});
  // areas 0.04 and 0.01 of the page for 1 each: after the global scale 1.6 and 0.4
  EXPECT_NEAR(u.report.fill, 0.05, 1e-6);  // UVs are rounded
  EXPECT_NEAR(u.report.distortion.area, (1.6 + 1 / 1.6 + 0.4 + 1 / 0.4) / 2, 1e-6);
  EXPECT_NEAR(u.report.distortion.angle, 2, 1e-6);
  EXPECT_NEAR(u.report.charts[0].distortion.area, 2, 1e-6);
}

TEST(ConstrainedUnwrap, SaysWhenChartsReachBeyondThePage) {
  const auto notes = [](double u) {
    return unwrapped({shapes::grid(3, 3)}, {.constraints = {pin(0, 0.1, 0.1), pin(3, u, 0.1)}})
        .report.notes.size();
  };
  EXPECT_EQ(notes(0.9), 0U);
  EXPECT_EQ(notes(1.1), 1U);
  const Vec2 far(0.1, 40.7);  // held in floats there too
  const Unwrapped u =
      unwrapped({shapes::grid(3, 3)}, {.constraints = {pin(0, 0.1, 40.2), pin(3, 0.1, 40.7)}});
  EXPECT_LT((u.surfaces[0].uv[3] - far).norm(), 4e-6);
}

TEST(ConstrainedUnwrap, HoldsOnACutSurfaceToo) {
  const TriMesh mesh = shapes::sphere(2);
  for (Method method : kMethods) {
    UnwrapOptions options{.method = method, .guarantee = Guarantee::none};
    options.constraints = {pin(0, 0.2, 0.2), pin(3, 0.8, 0.3), pin(1, 0.5, 0.9)};
    const Unwrapped u = unwrapped({mesh}, options);
    for (const PositionConstraint& c : options.constraints)
      EXPECT_EQ(u.surfaces[0].uv[std::size_t(*c.vertex)], as_written(c.uv));
  }
}

TEST(ConstrainedUnwrap, HoldsEveryMapOfACurve) {
  UnwrapOptions options{.method = Method::hybrid, .lambda_curve = {0, 1e-4, 0.1, 10}};
  options.constraints = {pin(0, 0.1, 0.1), pin(9, 0.9, 0.1), pin(99, 0.9, 0.8)};
  const std::vector<Surface> surfaces{shapes::surface_of(shapes::random_disk(9, 3))};
  SerialExecutor serial;
  const std::vector<Unwrapped> maps = unwrap_curve(surfaces, options, {}, serial);
  ASSERT_EQ(maps.size(), 4U);
  for (const Unwrapped& map : maps) {
    for (const PositionConstraint& c : options.constraints)
      EXPECT_LE((map.surfaces[0].uv[std::size_t(*c.vertex)] - c.uv).norm(), 2 * kHalfStep);
    EXPECT_GT(map.report.fill, 0.01 * maps[0].report.fill);
  }
}

TEST(ConstrainedUnwrap, FillsCircleAndSquareAndPacksThem) {
  for (Method method : kMethods) {
    const auto fill = [&](BoundaryShape shape) {
      return unwrapped({shapes::sphere_cap(64, 8, 1.2)}, {.method = method, .boundary = shape});
    };
    const double page = std::pow(1 - 2 * 2.0 / 1024, 2);
    const Unwrapped square = fill(BoundaryShape::square), circle = fill(BoundaryShape::circle);
    EXPECT_NEAR(square.report.fill, page, 1e-3);
    EXPECT_NEAR(circle.report.fill, page * std::numbers::pi / 4, 3e-3);
    for (const Unwrapped* u : {&square, &circle}) {
      EXPECT_NEAR(signed_area(u->surfaces[0]), u->report.fill, 1e-5);
      for (const Vec2& p : u->surfaces[0].uv) EXPECT_TRUE(p.minCoeff() >= 0 && p.maxCoeff() <= 1);
    }
  }
}

/// Triangles of the written floats that are not counter-clockwise.
Index flips(const UnwrappedSurface& s) {
  Index count = 0;
  for (const auto& [a, b, c] : s.faces) {
    const Eigen::Vector2f u = s.uv[std::size_t(a)].cast<float>();
    const Vec2 p = (s.uv[std::size_t(b)].cast<float>() - u).cast<double>();
    const Vec2 q = (s.uv[std::size_t(c)].cast<float>() - u).cast<double>();
    count += p.x() * q.y() - p.y() * q.x() <= 0;
  }
  return count;
}

TEST(ConstrainedUnwrap, KeepsItsPromiseAroundPinsOrSaysThatItCannot) {
  int kept = 0, asked = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const TriMesh mesh = shapes::random_disk(9, seed);
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> off(-0.03, 0.03);
    UnwrapOptions options;
    for (Index v = Index(seed); v < mesh.vertex_count(); v += 17) {
      const Vec3& p = mesh.positions[std::size_t(v)];
      options.constraints.push_back(
          pin(v, 0.2 + 0.6 * p.x() + off(rng), 0.2 + 0.6 * p.y() + off(rng)));
    }
    for (Method method : kMethods) {
      options.method = method;
      ++asked;
      try {
        const Unwrapped u = unwrapped({mesh}, options);
        EXPECT_EQ(flips(u.surfaces[0]), 0);
        for (const PositionConstraint& c : options.constraints)
          EXPECT_LE((u.surfaces[0].uv[std::size_t(*c.vertex)] - c.uv).lpNorm<Eigen::Infinity>(),
                    kHalfStep);
        ++kept;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::guarantee_failed) << e.what();
      }
    }
  }
  EXPECT_GE(kept, asked / 2);
}

TEST(ConstrainedUnwrap, KeepsItsPromiseInsideACircle) {
  for (Method method : kMethods)
    for (unsigned seed : {1U, 2U, 3U}) {
      const Unwrapped u = unwrapped({shapes::random_disk(9, seed)},
                                    {.method = method, .boundary = BoundaryShape::circle});
      EXPECT_EQ(flips(u.surfaces[0]), 0);
    }
}

TEST(ConstrainedUnwrap, RefusesWhatCannotBe) {
  TriMesh mesh = shapes::grid(2, 2);
  mesh.positions.emplace_back(0.25, -0.1, 0);
  mesh.faces.push_back({0, 9, 1});  // an ear: flat on a side of the square
  const auto refused = [&](const UnwrapOptions& options, ErrorCode code, const std::string& where) {
    try {
      unwrapped({mesh}, options);
      ADD_FAILURE() << "not refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code) << e.what();
      EXPECT_EQ(e.where(), where);
    }
  };
  refused({.constraints = {pin(0, 0, 0), pin(1, 0, 0)}}, ErrorCode::invalid_constraint,
          "/constraints/1");
  refused({.method = Method::slim, .constraints = {pin(0, 0, 0)}}, ErrorCode::invalid_option,
          "/constraints");
  refused({.boundary = BoundaryShape::square, .constraints = {pin(0, 0, 0)}},
          ErrorCode::invalid_option, "/boundary");
  refused({.boundary = BoundaryShape::square}, ErrorCode::invalid_constraint, "/boundary");
  EXPECT_NO_THROW(
      unwrapped({mesh}, {.guarantee = Guarantee::none, .boundary = BoundaryShape::square}));
}

TEST(ConstrainedUnwrap, HoldsRealMeshes) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for (const char* name : {"Cow_dABF", "Balls"}) {
    const TriMesh mesh = read_obj(test_data() / "paper" / (std::string(name) + ".obj"));
    for (Method method : kMethods) {
      UnwrapOptions options{
          .method = method, .stop = {.iterations = 10}, .guarantee = Guarantee::none};
      options.constraints = {pin(10, 0.2, 0.2), pin(200, 0.7, 0.3)};
      const Unwrapped u = unwrapped({mesh}, options);
      for (const PositionConstraint& c : options.constraints)
        EXPECT_EQ(u.surfaces[0].uv[std::size_t(*c.vertex)], as_written(c.uv));
      EXPECT_GT(u.report.fill, 0);
    }
  }
}

/// Two opposite corners of a square are enough to place it.
double fill_of_square(const Vec2& low, const Vec2& high) {
  const TriMesh mesh = shapes::grid(6, 6);
  return unwrapped({mesh}, {.constraints = {pin(0, low.x(), low.y()),
                                            pin(mesh.vertex_count() - 1, high.x(), high.y())}})
      .report.fill;
}

TEST(ConstrainedUnwrap, FillIsTheShareOfThePageThatIsCovered) {
  EXPECT_NEAR(fill_of_square({0.25, 0.25}, {0.75, 0.75}), 0.25, 1e-6);
  EXPECT_NEAR(fill_of_square({0.5, 0.5}, {1.5, 1.5}), 0.25, 1e-6);
  EXPECT_NEAR(fill_of_square({-0.75, 0.25}, {0.25, 1.25}), 0.25 * 0.75, 1e-6);
  EXPECT_NEAR(fill_of_square({-1, -1}, {2, 2}), 1, 1e-6);
  EXPECT_NEAR(fill_of_square({0, 0}, {1e30, 1e30 / 3}), 0.75, 1e-6);  // aslant
  EXPECT_EQ(fill_of_square({2, 2}, {3, 3}), 0);
}

TEST(ConstrainedUnwrap, FillIsAtMostThePageWhereChartsLieOnEachOther) {
  const TriMesh mesh = shapes::grid(4, 4);
  UnwrapOptions options;
  for (const Index surface : {0, 1})
    for (const auto& [vertex, place] : {std::pair(Index{0}, 0.0), {mesh.vertex_count() - 1, 1.0}}) {
      options.constraints.push_back(pin(vertex, place, place));
      options.constraints.back().surface = surface;
    }
  EXPECT_EQ(unwrapped({mesh, mesh}, options).report.fill, 1);
}

}  // namespace
}  // namespace unwrapd
