#include "core/pipeline/order_layouts.hpp"

#include <gtest/gtest.h>

#include "tests/core/shapes.hpp"

namespace unwrapd::pipeline {
namespace {

using namespace shapes;

/// One chart, a flat grid on the page turned by as many quarters; measured as is told.
Layout layout_of(const Distortion& measured, int quarters) {
  const Surface surface = surface_of(grid(4, 4));
  Layout layout;
  layout.charts = {
      {std::make_shared<const charts::Chart>(charts::components_of(surface, {}).charts.front())}};
  UvMap uv;
  for (const Vec3& p : layout.charts[0][0]->mesh.positions) {
    Vec2 place(p.x(), p.y());
    for (int k = 0; k < quarters; ++k) place = Vec2(1 - place.y(), place.x());
    uv.push_back(place);
  }
  layout.islands = {{uv}};
  layout.constrained = {{{}}};
  layout.report.distortion = measured;
  layout.report.charts = {{.iterations = 7, .energy = {1, 0.5}}};
  return layout;
}

UnwrapOptions list_of(const std::vector<double>& lambdas) {
  UnwrapOptions options;
  options.method = Method::hybrid;
  options.lambda_curve = lambdas;
  return options;
}

/// Whether the layout is that of layout_of() with these quarters.
bool shows(const Layout& layout, int quarters) {
  return layout.islands[0][0] == layout_of({}, quarters).islands[0][0];
}

TEST(OrderLayouts, LeavesThoseThatAreInOrder) {
  SerialExecutor serial;
  std::vector<Layout> layouts = {layout_of({2.02, 2.00}, 0), layout_of({2.01, 2.01}, 1)};
  order_layouts(layouts, list_of({1, 0.1}), serial);  // any order of the list
  EXPECT_TRUE(shows(layouts[0], 0) && shows(layouts[1], 1));
  for (const Layout& layout : layouts) {
    EXPECT_EQ(layout.report.charts[0].stop_reason, StopReason::iterations);
    EXPECT_TRUE(layout.report.notes.empty());
  }
}

TEST(OrderLayouts, ReplacesOneByItsNearestAndSaysSo) {
  SerialExecutor serial;
  std::vector<Layout> layouts = {layout_of({2.01, 2.02}, 0), layout_of({2.05, 2.05}, 1),
                                 layout_of({2.02, 2.01}, 2)};  // the second is worse than both
  order_layouts(layouts, list_of({0.1, 1, 10}), serial);
  EXPECT_TRUE(shows(layouts[0], 0) && !shows(layouts[1], 1) && shows(layouts[2], 2));
  const ChartReport& chart = layouts[1].report.charts[0];
  EXPECT_EQ(chart.stop_reason, StopReason::neighbour);
  EXPECT_EQ(chart.iterations, 0);
  ASSERT_EQ(chart.energy.size(), 1U);
  EXPECT_NEAR(chart.energy[0], 0, 1e-12);  // of a flat grid, for the lambda that was asked for
  ASSERT_EQ(layouts[1].report.notes.size(), 1U);
  EXPECT_EQ(layouts[1].report.notes[0].code, NoteCode::lambda_repeated);
  EXPECT_TRUE(layouts[0].report.notes.empty() && layouts[2].report.notes.empty());
}

TEST(OrderLayouts, LeavesAGivenNumberOfIterationsAlone) {
  SerialExecutor serial;
  std::vector<Layout> layouts = {layout_of({2.05, 2.00}, 0), layout_of({2.01, 2.05}, 1)};
  UnwrapOptions options = list_of({0.1, 1});
  options.stop.iterations = 10;
  order_layouts(layouts, options, serial);
  EXPECT_TRUE(shows(layouts[0], 0) && shows(layouts[1], 1));
}

}  // namespace
}  // namespace unwrapd::pipeline
