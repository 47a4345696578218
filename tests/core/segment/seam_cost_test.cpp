// Seams where they show least, and no longer than they must be.
#include <gtest/gtest.h>

#include <cmath>

#include "core/mesh/edges.hpp"
#include "core/segment/search/close_slits.hpp"
#include "core/segment/segment_charts.hpp"
#include "tests/core/segment/segmentation_mesh_of.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;

/// Half-edges whose length counts less.
std::size_t creases_of(const SegmentationMesh& surface) {
  std::size_t count = 0;
  for (std::size_t h = 0; h < surface.length.size(); ++h)
    if (surface.seam_cost[h] != surface.length[h]) {
      EXPECT_LT(surface.seam_cost[h], surface.length[h]);
      ++count;
    }
  return count;
}

TEST(SeamCost, IsLessAlongSharpEdgesAndGivenOnesUnlessMostAre) {
  EXPECT_EQ(creases_of(segmentation_mesh_of(cube(1))),
            2U * 12 * 2);  // twelve edges in two pieces, both sides
  EXPECT_EQ(creases_of(segmentation_mesh_of(sphere(3))), 0U);
  const TriMesh plane = grid(4, 4);
  std::vector<char> given(3 * plane.faces.size(), 0);
  EXPECT_EQ(creases_of(segmentation_mesh_of(plane, given)), 0U);
  const SegmentationMesh surface = segmentation_mesh_of(plane);
  const auto h = std::size_t(
      std::ranges::find_if(surface.halfedges.twin, [](Index twin) { return twin != kNoTwin; }) -
      surface.halfedges.twin.begin());
  given[h] = given[std::size_t(surface.halfedges.twin[h])] = 1;
  EXPECT_EQ(creases_of(segmentation_mesh_of(plane, given)), 2U);
  EXPECT_EQ(creases_of(segmentation_mesh_of(plane, std::vector<char>(given.size(), 1))), 0U);
}

/// 1 for each face above the equator, else 0.
std::vector<Index> halves(const TriMesh& mesh) {
  std::vector<Index> half;
  for (const Triangle& face : mesh.faces) {
    double z = 0;
    for (const Index v : face) z += mesh.positions[std::size_t(v)].z();
    half.push_back(z > 0 ? 1 : 0);
  }
  return half;
}

std::ptrdiff_t flagged(const Surface& surface) {
  const charts::Charts charts = charts::components_of(surface, {.mode = SeamMode::none});
  return std::ranges::count(charts.charts.front().crease, 1);
}

TEST(SeamCost, KnowsWhereMaterialsMeetAndWhereTheInputWasSplit) {
  const TriMesh mesh = sphere(2);
  const std::vector<Index> half = halves(mesh);
  const std::vector<Index> one(half.size(), 0);
  const Surface painted{mesh, half, "two materials on the same vertices"};
  EXPECT_EQ(flagged(painted), 2 * 16);  // the equator
  EXPECT_EQ(flagged(in_parts(mesh, half)), 2 * 16);
  EXPECT_EQ(flagged(surface_of(in_parts(mesh, half).mesh)), 2 * 16);  // one material, split there
  EXPECT_EQ(flagged(surface_of(mesh)), 0);
}

/// The share of all chart borders that lies at this distance from the axis.
double share_at(double distance, const Surface& surface) {
  std::vector<charts::Charts> surfaces{charts::components_of(surface, {})};
  SerialExecutor serial;
  segment_charts(surfaces, {}, {}, serial);
  const auto is_there = [&](const Vec3& p) {
    return p.z() > 0 && std::abs(std::hypot(p.x(), p.y()) - distance) < 1e-9;
  };
  double all = 0, there = 0;
  for (const charts::Chart& chart : surfaces.front().charts)
    for (const BoundaryLoop& loop : chart.loops)
      for (const Index h : loop) {
        const Vec3 &a = chart.mesh.positions[std::size_t(start_of(chart.mesh.faces, h))],
                   &b = chart.mesh.positions[std::size_t(end_of(chart.mesh.faces, h))];
        all += (a - b).norm();
        if (is_there(a) && is_there(b)) there += (a - b).norm();
      }
  return there / all;
}

/// Around a torus, where its seams would not run: half of the tube's width off its top. Each of the
/// searches swings by its lots.
TEST(SeamCost, DrawsSeamsToWhereMaterialsMeet) {
  double plain = 0, painted = 0;
  for (const Index around : {20, 24, 28, 32, 36, 40, 44, 48}) {
    const TriMesh mesh = torus(around, 12);
    const double distance = 1 + 0.4 * std::cos(M_PI / 3);
    std::vector<Index> material;
    for (const Triangle& face : mesh.faces) {
      Vec3 middle = Vec3::Zero();
      for (const Index v : face) middle += mesh.positions[std::size_t(v)] / 3;
      material.push_back(middle.z() > 0.4 * std::sin(M_PI / 3) ||
                                 std::hypot(middle.x(), middle.y()) < distance
                             ? 1
                             : 0);
    }
    plain += share_at(distance, surface_of(mesh));
    painted += share_at(distance, {mesh, material, "painted"});
  }
  EXPECT_GT(painted, plain + 0.2) << plain;
}

/// All faces as one region, mapped by `place`, slit along the edges for which is_slit is true.
template <class IsSlit>
Partition slit_open(const SegmentationMesh& surface, IsSlit is_slit) {
  Partition whole{std::vector<MappedRegion>(1), std::vector<char>(surface.length.size(), 0)};
  for (Index h = 0; h < Index(surface.length.size()); ++h)
    if (surface.halfedges.twin[std::size_t(h)] != kNoTwin &&
        is_slit(surface.mesh.positions[std::size_t(start_of(surface.mesh.faces, h))],
                surface.mesh.positions[std::size_t(end_of(surface.mesh.faces, h))]))
      whole.open[std::size_t(h)] = 1;
  MappedRegion& region = whole.regions.front();
  for (Index t = 0; t < surface.face_count(); ++t) region.faces.push_back(t);
  region.uv = projected(surface, region.faces);
  region.area = 1;
  region.excess =
      test_parameterization(surface, whole.open, {.iterations = 40, .most_excess = 1}, region)
          .excess;
  region.is_sound = true;
  return whole;
}

double slit_length(const SegmentationMesh& surface, const Partition& partition) {
  double length = 0;
  for (std::size_t h = 0; h < partition.open.size(); ++h)
    if (partition.open[h] != 0) length += surface.length[h] / 2;
  return length;
}

TEST(CloseSlits, ClosesOnesThatAreOfNoUse) {
  const SegmentationMesh surface = segmentation_mesh_of(grid(8, 8));
  const auto on_line = [](const Vec3& a, const Vec3& b) {
    return std::abs(a.y()) < 1e-9 && std::abs(b.y()) < 1e-9 && std::min(a.x(), b.x()) > -0.3;
  };
  Partition whole = slit_open(surface, on_line);
  EXPECT_GT(slit_length(surface, whole), 0.5);
  search::close_slits({surface}, {.budget = 0.02, .cap = 0.08}, whole);
  EXPECT_EQ(slit_length(surface, whole), 0);
  EXPECT_LT(whole.regions.front().excess.worst(), 1e-6);
}

/// A cap opened from its rim to the pole.
Partition opened_cap(const SegmentationMesh& surface) {
  const Vec3 pole =
      *std::ranges::max_element(surface.mesh.positions, {}, [](const Vec3& p) { return p.z(); });
  return slit_open(surface, [&](const Vec3& a, const Vec3& b) {
    return std::abs(a.y() - pole.y()) < 1e-9 && std::abs(b.y() - pole.y()) < 1e-9 &&
           std::min(a.x(), b.x()) > pole.x() - 1e-9;
  });
}

/// The more may be bent, by either bound, the less stays open; the rest would bend it more.
TEST(CloseSlits, ClosesOnesFromTheirTipAsFarAsEitherBoundGoesAndKeepsTheMapSound) {
  const SegmentationMesh surface = segmentation_mesh_of(sphere_cap(24, 12, 1.3));
  const Partition open = opened_cap(surface);
  const double least = open.regions.front().excess.worst();
  for (const bool is_of_all : {true, false}) {
    double last = slit_length(surface, open);
    for (const double bound : {0.01, 0.02, 0.2}) {
      Partition glued = open;
      search::close_slits({surface},
                          {.budget = is_of_all ? bound : 1, .cap = is_of_all ? 1 : bound}, glued);
      EXPECT_LT(slit_length(surface, glued), last) << bound;
      last = slit_length(surface, glued);
      const MappedRegion& region = glued.regions.front();
      EXPECT_LE(region.excess.worst(), std::max(bound, least)) << is_of_all;
      Region again = region;
      EXPECT_EQ(test_parameterization(surface, glued.open, {.most_excess = 1}, again).verdict,
                Verdict::sound);
    }
    EXPECT_EQ(last, 0);
  }
}

/// The bound of all regions counts what the others have.
TEST(CloseSlits, LeavesOneOpenWhereTheOthersHaveAllThatThereIs) {
  const SegmentationMesh surface = segmentation_mesh_of(sphere_cap(24, 12, 1.3));
  Partition open = opened_cap(surface);
  MappedRegion& elsewhere = open.regions.emplace_back();
  elsewhere.excess = {0.19, 0.19};
  const double before = slit_length(surface, open);
  Partition glued = open;
  search::close_slits({surface}, {.budget = 1, .cap = 0.2}, glued);
  EXPECT_EQ(slit_length(surface, glued), 0);
  glued = open;
  search::close_slits({surface}, {.budget = 0.2, .cap = 0.2}, glued);
  EXPECT_GT(slit_length(surface, glued), before / 2);
  EXPECT_LE((glued.regions[0].excess + glued.regions[1].excess).worst(), 0.2);
}

}  // namespace
}  // namespace unwrapd::segment
