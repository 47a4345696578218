// The regions that merging starts from, on boxes, whose best unfolding is known.
#include "core/segment/search/over_segment.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/segment/base/progress_estimate.hpp"
#include "tests/core/segment/cut_up.hpp"
#include "tests/core/segment/segmentation_mesh_of.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

/// A box of twelve triangles; size: at each axis.
TriMesh box(const Vec3& size) {
  TriMesh mesh = shapes::cube(0);
  for (Vec3& p : mesh.positions) p = p.cwiseProduct(size);
  return mesh;
}

const std::vector<Vec3> kThin = {
    {10, 0.5, 6}, {1, 0.1, 2}, {10, 2, 0.3}, {0.2, 3, 2}, {5, 4, 0.05}};

TEST(OverSegment, DoesNotFoldAThinSideOntoALargeOne) {
  for (const Vec3& size : kThin) {
    const SegmentationMesh surface = segmentation_mesh_of(box(size));
    ProgressEstimate progress({});
    SerialExecutor serial;
    const auto regions = search::over_segment({surface, &progress, nullptr, {}}, 0.02, serial);
    EXPECT_EQ(regions.size(), 6U) << size.transpose();
    for (const MappedRegion& region : regions) EXPECT_LT(region.excess.worst(), 1e-9);
  }
}

/// Six faces hang together by five of twelve edges: three of the longest, which go around, and two
/// of the next. All others are seams. They are no flaps: the boxes are thin.
TEST(OverSegment, LetsThinBoxesUnfoldAlongTheirShortestSeams) {
  for (const Vec3& size : kThin) {
    const Cut cut = cut_up(box(size));
    ASSERT_EQ(cut.surfaces.front().charts.size(), 1U) << size.transpose();
    double seam = 0;
    const charts::Chart& chart = cut.surfaces.front().charts.front();
    for (const BoundaryLoop& loop : chart.loops)
      for (const Index h : loop) {
        const Triangle& face = chart.mesh.faces[std::size_t(h / 3)];
        seam += (chart.mesh.positions[std::size_t(face[std::size_t(h + 1) % 3])] -
                 chart.mesh.positions[std::size_t(face[std::size_t(h) % 3])])
                    .norm() /
                2;
      }
    std::multiset<double> side(size.begin(), size.end());
    const double c = *side.begin(), b = *std::next(side.begin()), a = *side.rbegin();
    EXPECT_NEAR(seam, a + 2 * b + 4 * c, 1e-9) << size.transpose();
    EXPECT_NEAR(distortion_by_svd(cut)[0], 2, 1e-9);
  }
}

}  // namespace
}  // namespace unwrapd::segment
