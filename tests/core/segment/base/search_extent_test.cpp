#include "core/segment/base/search_extent.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/core/segment/cut_up.hpp"
#include "tests/core/shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;

constexpr std::array kEfforts = {Effort::fast, Effort::balanced, Effort::best};

TEST(SegmentEffort, KeepsTheBoundWithSoundMapsOnAnyNumberOfThreads) {
  for (const Effort effort : kEfforts)
    for (const TriMesh& mesh : {sphere(2), torus(16, 8), pierced_bar(2), sphere_cap(16, 8, 1.5)}) {
      const SegmentOptions options{.max_distortion = 2.02, .effort = effort};
      const Cut cut = cut_up(mesh, options);
      expect_sound(cut, mesh.faces.size());
      EXPECT_LE(distortion_by_svd(cut)[0], 2.02);
      EXPECT_LE(distortion_by_svd(cut)[1], 2.02);
      TwoThreads two;
      std::vector<charts::Charts> threaded{charts::components_of(surface_of(mesh), {})};
      segment_charts(threaded, options, {}, two);
      ASSERT_EQ(threaded[0].charts.size(), cut.surfaces[0].charts.size());
      for (std::size_t k = 0; k < threaded[0].charts.size(); ++k)
        EXPECT_EQ(threaded[0].charts[k].start, cut.surfaces[0].charts[k].start);
    }
}

/// On one mesh less may be tried with more, where a better merge leaves less to be cut.
TEST(SegmentEffort, TriesMoreWithMore) {
  std::array<int, 3> tests{};  // batches of them that were told of
  for (const TriMesh& mesh : {sphere(3), torus(24, 12), torus(16, 8), pierced_bar(2)})
    for (std::size_t k = 0; k < kEfforts.size(); ++k) {
      SegmentWatch watch;
      watch.on_progress = [&](Stage, double) { ++tests[k]; };
      cut_up(mesh, {.effort = kEfforts[k]}, watch);
    }
  EXPECT_LT(tests[0], tests[1]);
  EXPECT_LT(tests[1], tests[2]);
}

}  // namespace
}  // namespace unwrapd::segment
