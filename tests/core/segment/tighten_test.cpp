#include "core/segment/tighten.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "core/segment/chart_excess.hpp"
#include "core/segment/region_charts.hpp"
#include "tests/core/segment/cut_up.hpp"

namespace unwrapd::segment {
namespace {

/// A search of its own for each chart.
std::vector<charts::Chart> split(const charts::Chart& chart, double bound) {
  SerialExecutor serial;
  const SegmentationMesh surface = make_segmentation_mesh(chart.mesh, chart.halfedges);
  return region_charts(chart, segment(surface, {.max_distortion = bound}, serial));
}

std::vector<charts::Chart> charts_of_a_ball() {
  return std::move(cut_up(shapes::sphere(3)).surfaces.front().charts);
}

TEST(Tighten, SplitsChartsUntilTheyKeepTheBoundAndMovesNoSeam) {
  SerialExecutor serial;
  const std::vector<charts::Chart> loose = charts_of_a_ball();
  std::vector<std::size_t> chart_of(shapes::sphere(3).faces.size());
  for (std::size_t k = 0; k < loose.size(); ++k)
    for (const Index face : loose[k].face_source) chart_of[std::size_t(face)] = k;
  for (const double bound : {2.01, 2.005, 2.001}) {
    const std::vector<charts::Chart> tight =
        tighten(loose, bound, std::numeric_limits<Index>::max(), split, serial, {});
    EXPECT_GT(tight.size(), loose.size());
    EXPECT_LE(chart_excess(tight, serial, {}).mean.worst(), bound - 2);
    std::size_t faces = 0;
    for (const charts::Chart& chart : tight) {
      expect_disk(chart);
      faces += chart.face_source.size();
      for (const Index face : chart.face_source)
        EXPECT_EQ(chart_of[std::size_t(face)], chart_of[std::size_t(chart.face_source.front())]);
    }
    EXPECT_EQ(faces, chart_of.size());
  }
}

TEST(Tighten, LeavesWhatKeepsTheBound) {
  SerialExecutor serial;
  const std::vector<charts::Chart> loose = charts_of_a_ball();
  const auto never = [](const charts::Chart&, double) -> std::vector<charts::Chart> {
    ADD_FAILURE() << "a chart was split";
    return {};
  };
  EXPECT_EQ(tighten(loose, 2.5, 100, never, serial, {}).size(), loose.size());
}

TEST(Tighten, SplitsNoChartThatWouldMakeTooMany) {
  SerialExecutor serial;
  const std::vector<charts::Chart> loose = charts_of_a_ball();
  const auto most = static_cast<Index>(loose.size());
  EXPECT_EQ(tighten(loose, 2.001, most, split, serial, {}).size(), loose.size());
}

TEST(Tighten, SearchesForOneBoundBeyondTheLastStep) {
  for (const double bound : {2.02, 3.0}) EXPECT_EQ(tight_bounds(bound, Effort::balanced).count, 0U);
  for (const double bound : {2.015, 2.01}) {
    EXPECT_EQ(tight_bounds(bound, Effort::balanced).count, 1U);
    EXPECT_EQ(tight_bounds(bound, Effort::balanced).searched, (std::vector{2.01, 2.005}));
  }
  EXPECT_EQ(tight_bounds(2.004, Effort::balanced).count, 3U);
  EXPECT_EQ(tight_bounds(2.004, Effort::balanced).searched,
            (std::vector{2.01, 2.005, 2.002, 2.001}));
  const TightBounds all = tight_bounds(2.0001, Effort::balanced);
  EXPECT_EQ(all.count, all.searched.size());
  EXPECT_EQ(all.searched.back(), 2.0001);
  EXPECT_EQ(tight_bounds(2.004, Effort::fast).searched, (std::vector{2.01, 2.005, 2.002}));
}

}  // namespace
}  // namespace unwrapd::segment
