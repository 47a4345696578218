// On a flat sheet whatever is glued has a perfect map, so that every row of seams can become as
// short as its ends allow; on a dome a bound of distortion says how far.
#include "core/segment/search/shorten_seams.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/mesh/edges.hpp"
#include "core/segment/search/partition_cost.hpp"
#include "core/segment/search/seam_graph.hpp"
#include "core/segment/segment.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr Index kSide = 12;

SegmentationMesh sheet() {
  const TriMesh mesh = shapes::grid(kSide, kSide);
  return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
}

TriMesh bumpy_sphere(unsigned seed) {
  TriMesh mesh = shapes::sphere(4);
  std::mt19937 random(seed);
  std::array<Vec3, 5> bump;
  for (Vec3& b : bump)
    for (int i = 0; i < 3; ++i) b[i] = static_cast<double>(random() % 1000) / 500 - 1;
  for (Vec3& p : mesh.positions) {
    double height = 1;
    for (const Vec3& b : bump) height += 0.4 * std::exp(-8 * (p - b.normalized()).squaredNorm());
    p *= height;
  }
  return mesh;
}

Vec3 middle_of(const SegmentationMesh& surface, Index t) {
  Vec3 middle = Vec3::Zero();
  for (const Index v : surface.mesh.faces[std::size_t(t)])
    middle += surface.mesh.positions[std::size_t(v)] / 3;
  return middle;
}

/// With the maps that come from those of the regions.
void map(const SegmentationMesh& surface, Partition& parts) {
  for (MappedRegion& region : parts.regions) {
    for (const Index t : region.faces) region.area += surface.area(t);
    const TestRules rules{.most_excess = 1e9};
    const TestResult result = test_parameterization(surface, parts.open, rules, region);
    region.is_sound = result.verdict == Verdict::sound;
    region.excess = result.excess;
  }
}

/// One region for each value of label(middle of a face).
template <class Label>
Partition parted(const SegmentationMesh& surface, Label label) {
  Partition parts{{}, std::vector<char>(surface.length.size(), 0)};
  for (Index t = 0; t < surface.face_count(); ++t) {
    const auto k = std::size_t(label(middle_of(surface, t)));
    if (parts.regions.size() <= k) parts.regions.resize(k + 1);
    parts.regions[k].faces.push_back(t);
  }
  for (MappedRegion& region : parts.regions) region.uv = projected(surface, region.faces);
  map(surface, parts);
  return parts;
}

double zigzag(double x) {
  return 0.08 * (std::lround(std::floor(x * kSide / 2)) % 2 == 0 ? 1 : -1);
}

void expect_whole_and_sound(const SegmentationMesh& surface, const Partition& partition) {
  std::vector<int> seen(surface.mesh.faces.size(), 0);
  for (const MappedRegion& region : partition.regions) {
    for (const Index t : region.faces) ++seen[std::size_t(t)];
    Region again = region;
    const TestRules rules{.most_excess = 1e9};
    EXPECT_EQ(test_parameterization(surface, partition.open, rules, again).verdict, Verdict::sound);
  }
  EXPECT_TRUE(std::ranges::all_of(seen, [](int count) { return count == 1; }));
}

TEST(ShortenSeams, MakesAZigzagBetweenRegionsStraight) {
  const SegmentationMesh surface = sheet();
  Partition halves =
      parted(surface, [](const Vec3& m) { return m.y() < zigzag(m.x() + 0.5) ? 0 : 1; });
  const double before = seam_length(surface, halves);
  ASSERT_GT(before, 1.5);  // the sheet is 1 wide
  shorten_seams({surface}, {.budget = 1, .cap = 1}, halves);
  EXPECT_LT(seam_length(surface, halves), 1.2);
  expect_whole_and_sound(surface, halves);
}

/// Three stripes with zigzags between them.
TEST(ShortenSeams, MovesNoRowsButThoseBetweenTwoRegions) {
  const SegmentationMesh surface = sheet();
  Partition stripes = parted(surface, [](const Vec3& m) {
    const double y = m.y() - zigzag(m.x() + 0.5);
    return y < -0.2 ? 0 : y < 0.2 ? 1 : 2;
  });
  const std::vector<Index> before = owners(surface, stripes);
  const double length = seam_length(surface, stripes);
  shorten_between({surface}, {.budget = 1, .cap = 1}, 2, 1, stripes);
  EXPECT_LT(seam_length(surface, stripes), 0.85 * length);
  const std::vector<Index> after = owners(surface, stripes);
  for (std::size_t t = 0; t < after.size(); ++t) EXPECT_EQ(after[t] == 0, before[t] == 0);
  EXPECT_NE(after, before);
  expect_whole_and_sound(surface, stripes);
}

Index tip_of(const SegmentationMesh& surface) {
  const auto height = [](const Vec3& p) { return p.z(); };
  const auto& places = surface.mesh.positions;
  return Index(std::ranges::max_element(places, {}, height) - places.begin());
}

/// A cone of height 2 and radius 1, from where is_left() begins around to where it ends.
template <class IsLeft>
Region rolled_out(const SegmentationMesh& surface, IsLeft is_left) {
  const Vec3 tip = surface.mesh.positions[std::size_t(tip_of(surface))];
  const auto turn_of = [&](const Vec3& p) { return std::atan2(p.y() - tip.y(), p.x() - tip.x()); };
  const double share = 1 / std::sqrt(5.0);  // of the whole turn
  Region region;
  for (Index t = 0; t < surface.face_count(); ++t) {
    const Vec3 middle = middle_of(surface, t);
    const bool is_last = middle.x() > tip.x() && !is_left(middle);
    const double turn = turn_of(middle) + (is_last || turn_of(middle) < -1 ? 2 * M_PI : 0);
    CornerUv uv;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = surface.mesh.positions[std::size_t(surface.mesh.faces[std::size_t(t)][i])];
      const double own = turn + std::remainder(turn_of(p) - turn, 2 * M_PI);
      uv[i] = (p - tip).norm() * Vec2(std::cos(share * own), std::sin(share * own));
    }
    region.faces.push_back(t);
    region.uv.push_back(uv);
  }
  return region;
}

/// A slit from the tip of a cone to its rim, which the cone needs to lie flat. Its ends stay.
TEST(ShortenSeams, MakesAZigzagWithinARegionStraight) {
  const TriMesh mesh = shapes::cone(48, 16, 2);
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  const Vec3 tip = surface.mesh.positions[std::size_t(tip_of(surface))];
  const auto is_left = [&](const Vec3& m) {
    const double r = std::hypot(m.x() - tip.x(), m.y() - tip.y());
    return m.x() < tip.x() || std::atan2(m.y() - tip.y(), m.x() - tip.x()) > 0.4 * std::sin(40 * r);
  };
  std::vector<char> open(surface.length.size(), 0);
  for (Index h = 0; h < Index(open.size()); ++h) {
    const Index twin = surface.halfedges.twin[std::size_t(h)];
    if (twin == kNoTwin) continue;
    const Vec3 here = middle_of(surface, face_of(h)), there = middle_of(surface, face_of(twin));
    if (is_left(here) != is_left(there) && here.x() > 0 && there.x() > 0) open[std::size_t(h)] = 1;
  }
  Partition slit{{{rolled_out(surface, is_left), {}, 0, true}}, open};
  map(surface, slit);
  ASSERT_TRUE(slit.regions[0].is_sound);
  const auto ends = [&] {
    const SeamGraph seams(surface, slit);
    std::vector<Index> found;
    for (Index v = 0; v < surface.mesh.vertex_count(); ++v)
      if (seams.degree(v) == 1 || seams.degree(v) == 3) found.push_back(v);
    return found;
  };
  const std::vector<Index> before = ends();
  ASSERT_EQ(before.size(), 2U);
  const double length = seam_length(surface, slit);
  shorten_seams({surface}, {.budget = 1, .cap = 1}, slit);
  EXPECT_EQ(ends(), before);
  const Vec3 way = surface.mesh.positions[std::size_t(before[0])] -
                   surface.mesh.positions[std::size_t(before[1])];
  EXPECT_LT(seam_length(surface, slit), 0.8 * length);
  EXPECT_LT(seam_length(surface, slit), 1.15 * way.norm());
  expect_whole_and_sound(surface, slit);
}

/// A star within the sheet has no junction.
TEST(ShortenSeams, MakesARingShort) {
  const SegmentationMesh surface = sheet();
  Partition star = parted(surface, [](const Vec3& m) {
    const double turn = std::atan2(m.y(), m.x());
    return std::hypot(m.x(), m.y()) < 0.3 + 0.1 * std::cos(6 * turn) ? 0 : 1;
  });
  const double before = seam_length(surface, star);
  shorten_seams({surface}, {.budget = 1, .cap = 1}, star);
  EXPECT_LT(seam_length(surface, star), 0.9 * before);
  expect_whole_and_sound(surface, star);
}

/// The rim of a dome's top: a shorter ring would leave the belt below more to flatten than it is
/// allowed to, but its zigzag is not needed.
TEST(ShortenSeams, StaysNearWhereTheDistortionAsksForIt) {
  const TriMesh mesh = shapes::sphere_cap(48, 16, 1);
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  Partition dome = parted(surface, [&](const Vec3& m) {
    const double turn = std::atan2(m.y(), m.x());
    return std::hypot(m.x(), m.y()) < 0.3 + 0.02 * std::sin(24 * turn) ? 0 : 1;
  });
  ASSERT_TRUE(dome.regions[0].is_sound && dome.regions[1].is_sound);
  const auto excess = [&] { return (dome.regions[0].excess + dome.regions[1].excess).worst(); };
  const double before = seam_length(surface, dome), budget = 1.3 * excess(),
               top = dome.regions[0].area;
  shorten_seams({surface}, {.budget = budget, .cap = 1}, dome);
  EXPECT_LT(seam_length(surface, dome), 0.9 * before);
  EXPECT_GT(dome.regions[0].area, 0.7 * top);
  EXPECT_LE(excess(), budget);
  expect_whole_and_sound(surface, dome);
}

/// What segment() finds has nothing left to shorten.
TEST(ShortenSeams, IsTheLastStepOfTheSearch) {
  SerialExecutor serial;
  double before = 0, after = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const TriMesh mesh = bumpy_sphere(seed);
    const SegmentationMesh surface =
        make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
    Segments found = segment(surface, {.effort = Effort::fast}, serial);
    Partition partition{{}, std::move(found.open)};
    for (Region& region : found.regions)
      partition.regions.push_back({std::move(region), {}, 0, {}});
    map(surface, partition);
    const double budget = kMarginOfExcess * (kDefaultDistortion - 2);
    before += seam_length(surface, partition);
    shorten_in_parts({surface}, {.budget = budget, .cap = 4 * budget}, partition);
    after += seam_length(surface, partition);
  }
  EXPECT_GT(after, 0.99 * before);
}

double worst_mean(const Partition& partition) {
  return std::ranges::max(partition.regions, {}, &MappedRegion::mean_excess).mean_excess();
}

TEST(ShortenSeams, GetsFartherPartByPart) {
  int shorter = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const TriMesh mesh = shapes::random_disk(20, seed);
    const SegmentationMesh surface =
        make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
    Partition whole =
        parted(surface, [](const Vec3& m) { return m.y() < zigzag(m.x() + 0.5) ? 0 : 1; });
    Partition parts = whole;
    ExcessDistortion all;
    for (const MappedRegion& region : whole.regions) all += region.excess;
    const MergeSettings settings{.budget = all.worst(), .cap = 1e-3};
    const double most = std::max(settings.cap, worst_mean(whole));
    shorten_seams({surface}, settings, whole);
    shorten_in_parts({surface}, settings, parts);
    EXPECT_LE(std::max(worst_mean(whole), worst_mean(parts)), most * (1 + 1e-9)) << seed;
    EXPECT_LE(seam_length(surface, parts), 1.02 * seam_length(surface, whole)) << seed;
    shorter += seam_length(surface, parts) < 0.99 * seam_length(surface, whole) ? 1 : 0;
    expect_whole_and_sound(surface, parts);
  }
  EXPECT_GE(shorter, 2);
}

}  // namespace
}  // namespace unwrapd::segment::search
