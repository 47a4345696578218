#include "core/segment/whole_chart.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/segment/cut_up.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;

/// A flat ramp of one and a half turns: it is developable, and its flat image lies on itself.
TriMesh ramp() {
  return mapped_grid(60, 4, Wrap::none, [](double u, double v) {
    const double r = 0.5 + 0.5 * v, angle = 1.5 * kTurn * u;
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0.05 * angle);
  });
}

/// Whether regions were merged on the way.
bool is_searched(const TriMesh& mesh, double bound) {
  bool merges = false;
  SegmentWatch watch;
  watch.on_progress = [&](Stage stage, double) { merges = merges || stage == Stage::merge; };
  cut_up(mesh, {.max_distortion = bound}, watch);
  return merges;
}

TEST(SegmentWhole, KeepsADiskThatMeetsTheBoundWithoutASearch) {
  for (const TriMesh& mesh : {grid(1, 1), half_cylinder(12, 8), cone_sector(16, 8), annulus(24, 3),
                              sphere_cap(16, 8, 1.2), half_cylinder(120, 90)}) {
    EXPECT_FALSE(is_searched(mesh, 2.02)) << mesh.faces.size();
    const Cut whole = cut_up(mesh, {.max_distortion = 2.02});
    ASSERT_EQ(faces_of(whole).size(), 1U);
    EXPECT_EQ(whole.surfaces.front().charts[0].least, Guarantee::bijective);
    EXPECT_FALSE(whole.surfaces.front().charts[0].start.empty());
    EXPECT_TRUE(whole.surfaces.front().repairs.empty());
    EXPECT_LE(distortion_by_svd(whole)[0], 2.02);
    EXPECT_LE(distortion_by_svd(whole)[1], 2.02);
    if (mesh.faces.size() < 1000) expect_sound(whole, mesh.faces.size());
  }
}

TEST(SegmentWhole, KeepsNoDiskThatLiesOnItselfOrMissesTheBound) {
  for (const TriMesh& mesh : {ramp(), sphere_cap(16, 8, 2)}) {
    EXPECT_TRUE(is_searched(mesh, 2.02)) << mesh.faces.size();
    const Cut cut = cut_up(mesh, {.max_distortion = 2.02});
    EXPECT_GT(faces_of(cut).size(), 1U);
    expect_sound(cut, mesh.faces.size());
  }
}

}  // namespace
}  // namespace unwrapd::segment
