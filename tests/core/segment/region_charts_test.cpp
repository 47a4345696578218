#include "core/segment/region_charts.hpp"

#include <gtest/gtest.h>

#include "core/measure/orientation.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::segment {
namespace {

std::vector<charts::Chart> charts_through_a_small_surface(const charts::Chart& component,
                                                          Executor& executor) {
  const Coarse coarse = coarsen(component.mesh, component.halfedges, 2000, {});
  const SegmentationMesh surface = make_segmentation_mesh(coarse.mesh, coarse.halfedges);
  return region_charts(component, coarse, segment(surface, {}, executor), {});
}

double area_of_start(const charts::Chart& chart) {
  double area = 0;
  for (const Triangle& face : chart.mesh.faces) {
    const auto at = [&](std::size_t i) { return chart.start[std::size_t(face[i])]; };
    const Vec2 a = at(1) - at(0), b = at(2) - at(0);
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return area;
}

TEST(RegionCharts, ShallNotOverlapThemselves) {
  const charts::Charts whole = charts::components_of(shapes::surface_of(shapes::cube(1)), {});
  const charts::Chart& cube = whole.charts.front();
  SerialExecutor serial;
  const Segments segments = segment(make_segmentation_mesh(cube.mesh, cube.halfedges), {}, serial);
  const std::vector<charts::Chart> charts = region_charts(cube, segments);
  ASSERT_FALSE(charts.empty());
  for (const charts::Chart& chart : charts) EXPECT_EQ(chart.least, Guarantee::bijective);
}

TEST(RegionCharts, TakeANoisySurfaceApartIntoAFewDisksTheSameOnTwoThreads) {
  const TriMesh mesh = shapes::noisy(shapes::torus(150, 75, 1, 0.4), 0.004);  // edges of 0.04
  const charts::Charts whole = charts::components_of(shapes::surface_of(mesh), {});
  SerialExecutor one;
  TwoThreads two;
  const std::vector<charts::Chart> charts =
      charts_through_a_small_surface(whole.charts.front(), one);
  const std::vector<charts::Chart> again =
      charts_through_a_small_surface(whole.charts.front(), two);
  EXPECT_LE(charts.size(), 4U);
  ASSERT_EQ(again.size(), charts.size());
  std::size_t faces = 0;
  double area = 0;
  for (std::size_t k = 0; k < charts.size(); ++k) {
    EXPECT_TRUE(charts::is_disk(charts[k]));
    EXPECT_LE(measure::flipped_faces(charts[k].mesh.faces, charts[k].start).size(),
              charts[k].mesh.faces.size() / 100);
    EXPECT_EQ(again[k].start, charts[k].start);
    EXPECT_EQ(charts[k].least, Guarantee::bijective);
    area += area_of_start(charts[k]);
    faces += charts[k].mesh.faces.size();
  }
  EXPECT_EQ(faces, mesh.faces.size());
  EXPECT_NEAR(area, 1, 0.1);  // the surface's own, as all charts together have it
}

}  // namespace
}  // namespace unwrapd::segment
