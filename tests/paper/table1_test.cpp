// Table 1 of the paper on its own five models, every column, and the hybrid's way from ASAP to ARAP
// (Figs. 5, 6). ./dev bench table1 prints the table.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "core/charts/charts.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/solve.hpp"
#include "tests/bench/table1.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using bench::Column;
using bench::kColumns;
using bench::kModels;
using bench::kTolerance;
using bench::Model;

/// A figure that is not reached, and what comes out instead (docs/adr/0013).
struct Exception {
  std::string_view column, model;
  std::optional<double> angle, area;  ///< ours, where the printed one is not within kTolerance
};

constexpr std::array<Exception, 15> kExceptions{{
    {"LSCM", "Gargoyle", {}, 15.12},  // depends on the pins
    {"LSCM", "Isis", {}, 16.44},
    {"LSCM", "Balls", {}, 2.504},
    {"LSCM", "Cow", {}, 18.52},
    {"dABF", "Isis", {}, 8.246},
    {"LABF", "Isis", 2.075, 7.784},
    {"IC", "Gargoyle", 2.163, {}},
    {"IC", "Isis", 3.001, 3.794},
    {"IC", "Balls", 2.111, 2.345},
    {"IC", "Cow", {}, 2.340},
    {"IC", "Beetle", {}, 2.187},
    {"CP", "Isis", 2.101, 7.034},
    {"CP", "Balls", 2.025, 2.339},
    {"CP*", "Balls", {}, 3.140},  // rests on six triangles that no lengths make
    {"ARAP", "Isis", {}, 2.145},  // for every implementation that was tried
}};

Exception exception_of(const Column& column, const Model& model) {
  for (const Exception& e : kExceptions)
    if (e.column == column.name && e.model == model.name) return e;
  return {};
}

/// One of the paper's models as its one chart.
charts::Charts load(const char* file) {
  return charts::make_charts(shapes::surface_of(read_obj(test_data() / "paper" / file)),
                             SeamMode::automatic);
}

Distortion solved(const charts::Chart& chart, const UnwrapOptions& options) {
  const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops);
  SerialExecutor serial;
  const solve::Solution s = solve::Solver(disk, options, {}, serial).run(options.lambda, {});
  return measure::distortion(measure::distortion_sums(disk.rest, disk.faces, s.uv));
}

class Paper : public testing::Test {
 protected:
  void SetUp() override {
    if (test_data().empty()) GTEST_SKIP() << "the paper's models are not here (UNWRAPD_TEST_DATA)";
  }
};

/// One figure: the printed one where it is reached, else the one that is known to come out.
void expect_figure(double ours, std::optional<double> printed, std::optional<double> known) {
  if (!printed) return;
  const double expected = known.value_or(*printed);
  EXPECT_NEAR(ours, expected, known ? 0.01 * expected : kTolerance);
  EXPECT_TRUE(!known || bench::is_off(printed, ours)) << "no exception any more";
}

TEST_F(Paper, Table1IsReproduced) {
  for (std::size_t m = 0; m < kModels.size(); ++m) {
    const charts::Charts charts = load(kModels[m].file);
    ASSERT_EQ(charts.charts.size(), 1U) << kModels[m].name;
    for (const Column& column : kColumns) {
      const auto& printed = column.printed[m];
      if (!printed.angle) continue;
      SCOPED_TRACE(std::string(column.name) + " of " + kModels[m].name);
      const solve::Disk disk = solve::make_disk(charts.charts[0].mesh, charts.charts[0].loops);
      const UvMap uv = bench::map_of(disk, kModels[m], column);
      const Distortion d = measure::distortion(measure::distortion_sums(disk.rest, disk.faces, uv));
      const Exception known = exception_of(column, kModels[m]);
      expect_figure(d.angle, printed.angle, known.angle);
      expect_figure(d.area, printed.area, known.area);
      const bool may_flip =
          !column.method || column.method == Method::asap || column.method == Method::arap;
      EXPECT_TRUE(may_flip || d.flipped == 0) << d.flipped;
    }
  }
}

/// What another program gives for a method that came after the paper; a tolerance for D_area.
struct Peer {
  std::size_t model;
  double angle, area, tolerance;
};

void expect_peer(Method method, const Peer& peer) {
  SCOPED_TRACE(kModels[peer.model].name);
  const charts::Charts charts = load(kModels[peer.model].file);
  const Distortion d = solved(charts.charts[0], {.method = method});
  EXPECT_NEAR(d.angle, peer.angle, 0.005);
  EXPECT_NEAR(d.area, peer.area, peer.tolerance);
  EXPECT_EQ(d.flipped, 0);
}

TEST_F(Paper, BoundaryFirstFlatteningAgreesWithItsAuthorsProgram) {
  for (const Peer& peer : {Peer{0, 2.004, 2.649, 0.01},
                           {1, 2.050, 6.66, 0.5},  // theirs depends on an axis, see bff.cpp
                           {2, 2.026, 2.392, 0.01},
                           {3, 2.010, 2.172, 0.01},
                           {4, 2.001, 2.098, 0.01}})
    expect_peer(Method::bff, peer);
}

TEST_F(Paper, SymmetricDirichletAgreesWithLibigl) {  // Gargoyle takes too long for a test
  for (const Peer& peer : {Peer{1, 2.156, 2.088, 0.01},
                           {2, 2.075, 2.045, 0.01},
                           {3, 2.022, 2.011, 0.01},
                           {4, 2.013, 2.011, 0.01}})
    expect_peer(Method::slim, peer);
}

/// Converged figures for lambda as printed, the mesh scaled to area 1 (Figs. 5 and 6).
struct Step {
  double lambda, angle, area;
};

void expect_curve(const char* file, std::initializer_list<Step> steps) {
  const charts::Charts charts = load(file);
  const double area = measure::surface_area(charts.charts[0].mesh);
  std::printf("%-13s lambda  D_angle  D_area\n", file);
  Distortion last{.angle = 0, .area = 1e9};
  for (const Step& step : steps) {
    const UnwrapOptions options{.method = Method::hybrid,
                                .lambda = step.lambda * area,  // Eq. (5) grows with area
                                .lambda_units = LambdaUnits::paper,
                                .stop = {.iterations = 2000}};
    const Distortion d = solved(charts.charts[0], options);
    std::printf("%20g  %.4f   %.4f\n", step.lambda, d.angle, d.area);
    EXPECT_NEAR(d.angle, step.angle, 0.002) << step.lambda;
    EXPECT_NEAR(d.area, step.area, 0.006 * step.area) << step.lambda;
    EXPECT_LT(d.area, last.area * (1 + 1e-6)) << step.lambda;
    EXPECT_GT(d.angle, last.angle - 1e-6) << step.lambda;
    last = d;
  }
}

TEST_F(Paper, HybridWalksFromConformalToRigidOnIsis) {
  expect_curve("Isis_dABF.obj", {{1e-4, 2.049, 5.61},
                                 {1e-3, 2.097, 2.53},
                                 {1e-2, 2.175, 2.166},
                                 {0.1, 2.190, 2.147},
                                 {1, 2.192, 2.145},
                                 {1000, 2.192, 2.144}});
}

TEST_F(Paper, HybridWalksFromConformalToRigidOnBalls) {
  expect_curve("Balls.obj", {{1e-4, 2.025, 2.218},
                             {1e-3, 2.046, 2.098},
                             {1e-2, 2.068, 2.059},
                             {0.1, 2.073, 2.054},
                             {1, 2.073, 2.054},
                             {1000, 2.073, 2.054}});
}

TEST_F(Paper, DimensionlessLambdaIsMonotone) {
  for (const char* file : {"Isis_dABF.obj", "Balls.obj"}) {
    const charts::Charts charts = load(file);
    Distortion last{.angle = 0, .area = 1e9};
    for (double lambda : {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 100.0, 1e4}) {
      const Distortion d =
          solved(charts.charts[0],
                 {.method = Method::hybrid, .lambda = lambda, .stop = {.iterations = 1000}});
      EXPECT_LT(d.area, last.area * (1 + 1e-6)) << file << ' ' << lambda;
      EXPECT_GT(d.angle, last.angle - 1e-6) << file << ' ' << lambda;
      last = d;
    }
  }
}

}  // namespace
}  // namespace unwrapd
