#include <gtest/gtest.h>

#include <map>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
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

TEST(UnwrapCurve, GivesForEachLambdaWhatThatLambdaAloneGives) {
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

TEST(UnwrapCurve, RefusesALambdaBelowZero) {
  EXPECT_THROW(curve({shapes::surface_of(shapes::grid(3, 3))}, curve_of({1, -1})), Error);
}

}  // namespace
}  // namespace unwrapd
