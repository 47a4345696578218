#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

UnwrapOptions curve_of(std::vector<double> lambdas) {
  return {.method = Method::hybrid, .lambda_curve = std::move(lambdas)};
}

std::vector<Unwrapped> curve(const std::vector<Surface>& surfaces, const UnwrapOptions& options,
                             const Progress& progress = {}) {
  SerialExecutor serial;
  return unwrap_curve(surfaces, options, progress, serial);
}

std::vector<Surface> two_surfaces() {
  return {shapes::surface_of(shapes::random_disk(12, 5)), shapes::surface_of(shapes::sphere(2))};
}

TEST(UnwrapCurve, GivesForEachLambdaWhatThatLambdaAloneGivesWhereThatIsInOrder) {
  const std::vector<double> lambdas{10, 0, 0.1, 1e-5, 1};
  const std::vector<Unwrapped> maps = curve(two_surfaces(), curve_of(lambdas));
  ASSERT_EQ(maps.size(), lambdas.size());
  SerialExecutor serial;
  for (std::size_t k = 0; k < lambdas.size(); ++k) {
    const UnwrapOptions alone{.method = Method::hybrid, .lambda = lambdas[k]};
    const Unwrapped single = unwrap(two_surfaces(), alone, {}, serial);
    for (std::size_t s = 0; s < single.surfaces.size(); ++s)
      EXPECT_EQ(maps[k].surfaces[s].uv, single.surfaces[s].uv) << "lambda " << lambdas[k];
    EXPECT_EQ(maps[k].report.charts.back().energy, single.report.charts.back().energy);
    EXPECT_TRUE(single.report.curve.empty());
  }
}

TEST(UnwrapCurve, IsInEveryReportInTheOrderAskedFor) {
  const std::vector<double> lambdas{1, 0.1, 0.5};
  const std::vector<Unwrapped> maps = curve(two_surfaces(), curve_of(lambdas));
  for (const Unwrapped& map : maps) {
    ASSERT_EQ(map.report.curve.size(), lambdas.size());
    for (std::size_t k = 0; k < lambdas.size(); ++k) {
      EXPECT_EQ(map.report.curve[k].lambda, lambdas[k]);
      EXPECT_EQ(map.report.curve[k].distortion.angle, maps[k].report.distortion.angle);
      EXPECT_EQ(map.report.curve[k].distortion.area, maps[k].report.distortion.area);
    }
  }
}

TEST(UnwrapCurve, TradesAngleForAreaAsLambdaGrows) {  // Sec. 6, Figs. 5 and 6
  UnwrapOptions options = curve_of({0.05, 0.2, 1, 10});
  options.guarantee = Guarantee::none;
  const auto maps = curve({shapes::surface_of(shapes::sphere_cap(24, 8, 1.2))}, options);
  const std::vector<CurvePoint>& points = maps.front().report.curve;
  for (std::size_t k = 1; k < points.size(); ++k) {
    EXPECT_GT(points[k].distortion.angle, points[k - 1].distortion.angle);
    EXPECT_LT(points[k].distortion.area, points[k - 1].distortion.area);
    EXPECT_GT(points[k].energy, points[k - 1].energy);
  }
}

TEST(UnwrapCurve, EnergyIsTheAreaWeightedMeanOfTheCharts) {
  const auto maps = curve(two_surfaces(), curve_of({0.3, 3}));
  for (std::size_t k = 0; k < maps.size(); ++k) {
    double area = 0, energy = 0;
    for (const ChartReport& chart : maps[k].report.charts)
      area += chart.area, energy += chart.area * chart.energy.back();
    EXPECT_NEAR(maps[k].report.curve[k].energy, energy / area, 1e-12);
  }
}

TEST(UnwrapCurve, FactorsOnceAndTellsOfEachLambdaWithoutGoingBack) {
  double last = 0;
  int factorisations = 0;
  std::map<double, int> iterations;
  Progress progress;
  progress.on_stage = [&](const StageEvent& e) {
    EXPECT_GE(e.fraction, last);
    last = e.fraction;
    factorisations += e.stage == Stage::factor ? 1 : 0;
  };
  progress.on_iteration = [&](const IterationEvent& e) {
    EXPECT_GE(e.fraction, last);
    last = e.fraction;
    ++iterations[e.lambda.value()];
  };
  curve({shapes::surface_of(shapes::random_disk(12, 6))}, curve_of({2, 1, 4}), progress);
  EXPECT_EQ(factorisations, 1);
  EXPECT_EQ(iterations.size(), 3U);
}

TEST(UnwrapCurve, CountsForTheHybridAlone) {
  UnwrapOptions options = curve_of({1, 2, 3});
  options.method = Method::arap;
  const auto maps = curve({shapes::surface_of(shapes::grid(3, 3))}, options);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_TRUE(maps[0].report.curve.empty());
}

/// How far the curve goes back on the way to greater lambdas, at most, in D or a 4000th above 4.
double way_back(std::vector<CurvePoint> points) {
  std::ranges::stable_sort(points, {}, &CurvePoint::lambda);
  double back = 0, angle = 0, area = std::numeric_limits<double>::infinity();
  for (const CurvePoint& point : points) {
    const auto [a, r] = std::pair(point.distortion.angle, point.distortion.area);
    back =
        std::max({back, (angle - a) / std::max(1.0, a / 4), (r - area) / std::max(1.0, area / 4)});
    angle = std::max(angle, a), area = std::min(area, r);
  }
  return back;
}

std::vector<double> random_lambdas(std::mt19937& rng) {
  std::uniform_real_distribution<double> decades(-3, 2);
  std::vector<double> lambdas{0};
  for (int k = 0; k < 6; ++k) lambdas.push_back(std::pow(10, decades(rng)));
  return lambdas;
}

/// More than half of a sphere, open and rough: its maps for small lambdas are out of order.
TriMesh rough_cap(unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> bump(0, 0.05);
  TriMesh mesh = shapes::sphere_cap(20, 8 + static_cast<Index>(seed % 3), 2.7);
  for (Vec3& p : mesh.positions) p += Vec3(bump(rng), bump(rng), bump(rng));
  return mesh;
}

TEST(UnwrapCurve, NeverGoesBack) {  // any list, any guarantee, one chart or several
  std::mt19937 rng(5);
  std::ptrdiff_t replaced = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    UnwrapOptions options = curve_of(random_lambdas(rng));
    options.guarantee = static_cast<Guarantee>(seed % 3);
    options.effort = Effort::fast;
    std::vector<Surface> surfaces{shapes::surface_of(rough_cap(seed))};
    if (seed % 4 == 3) surfaces.push_back(shapes::surface_of(rough_cap(seed + 100)));
    if (seed % 4 == 1) surfaces.push_back(shapes::surface_of(shapes::pierced_disk(8, seed)));
    const auto maps = curve(surfaces, options);
    EXPECT_LE(way_back(maps.front().report.curve), 1e-3) << seed;
    for (const Unwrapped& map : maps)
      replaced +=
          std::ranges::count(map.report.charts, StopReason::neighbour, &ChartReport::stop_reason);
  }
  EXPECT_GT(replaced, 10);  // else no list was out of order
}

TEST(UnwrapCurve, NeverGoesBackOnTheModelsOfThePaper) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for (const char* name : {"Isis_dABF.obj", "Beetle_ABF.obj", "Cow_dABF.obj"})
    for (const Guarantee guarantee : {Guarantee::none, Guarantee::flip_free}) {
      const auto path = test_data() / "paper" / name;
      UnwrapOptions options = curve_of({0, 0.01, 0.03, 0.1, 0.3, 1, 10});
      options.guarantee = guarantee;
      const auto maps = curve({shapes::surface_of(read_obj(path))}, options);
      EXPECT_LE(way_back(maps.front().report.curve), 1e-3) << name;
      EXPECT_LT(maps[3].report.distortion.angle + maps[3].report.distortion.area,
                maps[2].report.distortion.angle + maps[2].report.distortion.area);
    }
}

TEST(UnwrapCurve, TellsOfChartsWithAMapOfAnotherLambda) {
  const auto path = test_data() / "paper" / "Cow_dABF.obj";
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  const auto maps = curve({shapes::surface_of(read_obj(path))}, curve_of({0.1, 0.3}));
  const ChartReport& low = maps[0].report.charts[0];
  EXPECT_EQ(low.stop_reason, StopReason::neighbour);
  EXPECT_EQ(low.energy.size(), static_cast<std::size_t>(low.iterations) + 1);
  const auto is_told = [](const Unwrapped& map) {
    return std::ranges::count(map.report.notes, NoteCode::lambda_repeated, &Note::code);
  };
  EXPECT_EQ(is_told(maps[0]), 1);
  EXPECT_EQ(is_told(maps[1]), 0);
  EXPECT_NE(maps[0].surfaces[0].uv, maps[1].surfaces[0].uv);
}

TEST(UnwrapCurve, LeavesAGivenNumberOfIterationsAlone) {  // for comparison with the paper
  const auto path = test_data() / "paper" / "Cow_dABF.obj";
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  UnwrapOptions options = curve_of({0.1, 0.3});
  options.stop.iterations = 10;
  for (const Unwrapped& map : curve({shapes::surface_of(read_obj(path))}, options))
    EXPECT_EQ(map.report.charts[0].stop_reason, StopReason::iterations);
}

TEST(UnwrapCurve, RefusesALambdaBelowZero) {
  EXPECT_THROW(curve({shapes::surface_of(shapes::grid(3, 3))}, curve_of({1, -1})), Error);
}

}  // namespace
}  // namespace unwrapd
