#include "core/segment/search/attach_small_charts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/core/shapes.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr Index kAround = 32;

/// A tube of radius 1, open below and slit along its height, and the lid on it: two regions.
struct Can {
  SegmentationMesh surface;
  Partition parts;

  explicit Can(double height) {
    TriMesh mesh;
    for (const double z : {0.0, height})
      for (Index k = 0; k < kAround; ++k) {
        const double angle = 2 * std::numbers::pi * k / kAround;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), z);
      }
    mesh.positions.emplace_back(0, 0, height);
    for (Index k = 0; k < kAround; ++k) {
      const Index next = (k + 1) % kAround;
      mesh.faces.push_back({k, next, kAround + k});
      mesh.faces.push_back({next, kAround + next, kAround + k});
      mesh.faces.push_back({kAround + k, kAround + next, 2 * kAround});
    }
    surface = make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
    parts = {std::vector<MappedRegion>(2), std::vector<char>(surface.length.size(), 0)};
    for (Index t = 0; t < surface.face_count(); ++t) {
      Region& own = parts.regions[t % 3 == 2 ? 1 : 0];
      own.faces.push_back(t);
      parts.regions[t % 3 == 2 ? 1 : 0].area += surface.area(t);
    }
    const Index slit = 2, beyond = surface.halfedges.twin[slit];  // from vertex kAround to vertex 0
    parts.open[std::size_t(slit)] = parts.open[std::size_t(beyond)] = 1;
    for (MappedRegion& part : parts.regions) {
      part.uv = rolled_out(part.faces);
      part.is_sound =
          test_parameterization(surface, parts.open, {.most_excess = 1}, part).verdict ==
          Verdict::sound;
    }
  }

 private:
  /// Angle and height of what belongs to the tube, x and y of what belongs to the lid.
  [[nodiscard]] std::vector<CornerUv> rolled_out(const std::vector<Index>& faces) const {
    std::vector<CornerUv> uv;
    for (const Index t : faces) {
      CornerUv own;
      for (std::size_t i = 0; i < 3; ++i) {
        const Index v = surface.mesh.faces[std::size_t(t)][i];
        const Vec3& p = surface.mesh.positions[std::size_t(v)];
        const bool is_last = t / 3 == kAround - 1 && v % kAround == 0;
        const double angle = 2 * std::numbers::pi * (is_last ? kAround : v % kAround) / kAround;
        const double radius =
            Vec2(surface.mesh.positions[0].x(), surface.mesh.positions[0].y()).norm();
        own[i] = t % 3 == 2 ? Vec2(p.x(), p.y()) : Vec2(angle * radius, p.z());
      }
      uv.push_back(own);
    }
    return uv;
  }
};

const MergeSettings kRules{.budget = 0.02, .cap = 0.08}, kFlat{.budget = 1e-6, .cap = 0.08};

/// Edges of the lid that are no seams.
Index glued_edges(const Can& can) {
  Index glued = 0;
  for (Index k = 0; k < kAround; ++k) glued += can.parts.open[std::size_t(9 * k + 6)] == 0 ? 1 : 0;
  return glued;
}

TEST(HangSmall, HangsALidOnOneEdgeWhereItFitsNoOtherWay) {
  Can can(60);
  ASSERT_LT(can.parts.regions[1].area, kSmallRegion);
  for (const MappedRegion& part : can.parts.regions) ASSERT_TRUE(part.is_sound);
  SerialExecutor serial;
  ASSERT_EQ(
      merge_regions({can.surface}, Joiner(can.surface), can.parts, kFlat, serial).regions.size(),
      2U);
  attach_small_charts({can.surface}, kFlat, can.parts);
  ASSERT_EQ(can.parts.regions.size(), 1U);
  MappedRegion& whole = can.parts.regions[0];
  EXPECT_EQ(whole.faces.size(), can.surface.mesh.faces.size());
  EXPECT_NEAR(whole.area, 1, 1e-9);
  EXPECT_TRUE(whole.is_sound);
  EXPECT_LE(whole.excess.worst(), 1e-6);
  EXPECT_EQ(glued_edges(can), 1);
  EXPECT_EQ(test_parameterization(can.surface, can.parts.open, {.most_excess = 1}, whole).verdict,
            Verdict::sound);
}

TEST(HangSmall, GluesMoreOfTheBorderWhereDistortionMayBeSpent) {
  Can can(60);
  attach_small_charts({can.surface}, kRules, can.parts);
  ASSERT_EQ(can.parts.regions.size(), 1U);
  EXPECT_GT(glued_edges(can), 1);
  EXPECT_LE(can.parts.regions[0].excess.worst(), kRules.budget);
}

TEST(HangSmall, LeavesALargeRegionAChart) {
  Can can(5);
  ASSERT_GT(can.parts.regions[1].area, kSmallRegion);
  attach_small_charts({can.surface}, kRules, can.parts);
  EXPECT_EQ(can.parts.regions.size(), 2U);
}

}  // namespace
}  // namespace unwrapd::segment::search
