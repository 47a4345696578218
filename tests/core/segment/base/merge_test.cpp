#include "core/segment/base/merge.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "core/segment/base/failed_trials.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

/// Regions of a flat sheet, one for each value of label(middle of a face), with their own places
/// for maps.
template <class Label>
Partition parted(const SegmentationMesh& surface, Label label) {
  Partition parts{{}, std::vector<char>(surface.length.size(), 0)};
  for (Index t = 0; t < surface.face_count(); ++t) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : surface.mesh.faces[std::size_t(t)])
      middle += surface.mesh.positions[std::size_t(v)] / 3;
    const auto k = std::size_t(label(middle));
    if (parts.regions.size() <= k) parts.regions.resize(k + 1);
    parts.regions[k].faces.push_back(t);
  }
  for (MappedRegion& region : parts.regions) {
    region.uv = projected(surface, region.faces);
    for (const Index t : region.faces) region.area += surface.area(t);
    region.is_sound = true;
  }
  return parts;
}

SegmentationMesh without_creases(const TriMesh& mesh) {
  return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
}

std::size_t merged_count(const SegmentationMesh& surface, const Partition& from,
                         MergeSettings settings) {
  SerialExecutor serial;
  settings.budget = settings.cap = 0.02;
  return merge_regions({surface}, Joiner(surface), from, settings, serial).regions.size();
}

/// Halves of a strip 16 wide and 1 high, and of one 2 wide.
TEST(Merge, RefusesWhatIsTooLongForAPageOnlyWhereThePageShallBeFilled) {
  const auto half = [](const Vec3& middle) { return middle.x() < 0 ? 0 : 1; };
  const SegmentationMesh strip = without_creases(shapes::grid(16, 1, 16, 1)),
                         brick = without_creases(shapes::grid(4, 2, 2));
  EXPECT_EQ(merged_count(strip, parted(strip, half), {}), 1U);
  EXPECT_EQ(merged_count(strip, parted(strip, half), {.least_fill = 0.3}), 2U);
  EXPECT_EQ(merged_count(brick, parted(brick, half), {.least_fill = 0.3}), 1U);
  EXPECT_EQ(merged_count(strip, parted(strip, half), {.page_area = 10, .least_fill = 0.3}), 1U);
}

/// An L of three squares covers 6/7 of its convex hull.
TEST(Merge, RefusesALargeUnionThatFillsItsHullTooLittle) {
  TriMesh corner = shapes::grid(4, 4);
  std::erase_if(corner.faces, [&](const Triangle& face) {
    return std::ranges::all_of(face, [&](Index v) {
      const Vec3& p = corner.positions[std::size_t(v)];
      return p.x() >= 0.5 && p.y() >= 0.5;
    });
  });
  std::vector<Index> number(corner.positions.size(), -1);
  TriMesh mesh;
  for (const Triangle& face : corner.faces) {
    mesh.faces.push_back(face);
    for (Index& v : mesh.faces.back()) {
      if (number[std::size_t(v)] < 0) {
        number[std::size_t(v)] = mesh.vertex_count();
        mesh.positions.push_back(corner.positions[std::size_t(v)]);
      }
      v = number[std::size_t(v)];
    }
  }
  const SegmentationMesh surface = without_creases(mesh);
  const double bend = surface.mesh.positions[std::size_t(number[12])].y();  // (0.5, 0.5)
  const Partition halves = parted(surface, [&](const Vec3& m) { return m.y() < bend ? 0 : 1; });
  const auto count = [&](double least_solid, double page_area) {
    return merged_count(surface, halves,
                        {.page_area = page_area, .least_fill = 0.01, .least_solid = least_solid});
  };
  EXPECT_EQ(count(0.8, 1), 1U);
  EXPECT_EQ(count(0.9, 1), 2U);
  EXPECT_EQ(count(0.9, 30), 1U);  // too small a share of the page to matter
}

/// A comb of 25 x 24 squares, whose back and odd teeth are one region: each of its twelve unions
/// with an even tooth is tested once, when no other can be made first.
TEST(Merge, TestsNoTwoUnionsOfOneLargeRegionAtOnce) {
  const SegmentationMesh surface = without_creases(shapes::grid(25, 24, 25, 24));
  const Vec3 corner = surface.mesh.positions.front();
  const double side = std::sqrt(1.0 / 600);  // of a square: all are 1
  const Partition comb = parted(surface, [&](const Vec3& m) {
    const int column = int((m.x() - corner.x()) / side), row = int((m.y() - corner.y()) / side);
    return row == 23 && column % 2 == 1 ? (column + 1) / 2 : 0;
  });
  ASSERT_EQ(comb.regions.size(), 13U);
  ProgressEstimate progress({});
  SerialExecutor serial;
  const Partition all = merge_regions({.surface = surface, .progress = &progress}, Joiner(surface),
                                      comb, {.budget = 0.02, .cap = 0.02}, serial);
  EXPECT_EQ(all.regions.size(), 1U);
  double tested = 0;
  for (int tooth = 1; tooth <= 12; ++tooth) tested += 1200 - 24 + 2 * tooth;
  EXPECT_EQ(progress.done(), tested);
}

/// Sixteen squares: which unions come first is all the same by their borders.
TEST(Merge, DrawsLotsWhereItHasAWhim) {
  const SegmentationMesh surface = without_creases(shapes::grid(8, 8));
  const double side = surface.mesh.positions.back().x() - surface.mesh.positions.front().x();
  const Vec3 corner = surface.mesh.positions.front();
  const Partition squares = parted(surface, [&](const Vec3& m) {
    const auto cell = [&](int axis) { return int(4 * (m[axis] - corner[axis]) / side); };
    return 4 * cell(1) + cell(0);
  });
  const auto merged = [&](double noise, int seed) {
    SerialExecutor serial;
    std::vector<std::vector<Index>> faces;
    const MergeSettings settings{
        .budget = 0.02, .cap = 0.02, .noise = noise, .seed = seed, .enough = 6};
    for (const MappedRegion& region :
         merge_regions({surface}, Joiner(surface), squares, settings, serial).regions)
      faces.push_back(region.faces);
    return faces;
  };
  EXPECT_EQ(merged(0, 1), merged(0, 2));
  EXPECT_EQ(merged(0.3, 1), merged(0.3, 1));
  EXPECT_NE(merged(0.3, 1), merged(0.3, 2));
  EXPECT_NE(merged(0.3, 1), merged(0, 1));
}

/// Six sides of a cube lie flat as a cross, but only with slits, which are told.
TEST(Merge, TellsOfSlitsOnBothSides) {
  const TriMesh mesh = shapes::cube(1);
  const SegmentationMesh surface = without_creases(mesh);
  const auto side = [](const Vec3& m) {
    Eigen::Index axis = 0;
    m.cwiseAbs().maxCoeff(&axis);
    return 2 * int(axis) + (m[axis] > 0 ? 1 : 0);
  };
  SerialExecutor serial;
  const Partition all = merge_regions({surface}, Joiner(surface), parted(surface, side),
                                      {.budget = 0.02, .cap = 0.08}, serial);
  double slit = 0;
  for (std::size_t h = 0; h < all.open.size(); ++h) {
    if (all.open[h] == 0) continue;
    EXPECT_EQ(all.open[std::size_t(surface.halfedges.twin[h])], 1);
    slit += surface.length[h] / 2;
  }
  EXPECT_EQ(all.regions.size(), 1U);
  EXPECT_NEAR(slit, 7 * std::sqrt(1.0 / 6), 1e-9);  // of twelve edges a tree of five is glued
}

/// Of its hull a cross of six squares covers 6/9: its outline runs along the slits that it opens.
TEST(Merge, MeasuresTheShapeThatSlitsGive) {
  const SegmentationMesh surface = without_creases(shapes::cube(1));
  const auto side = [](const Vec3& m) {
    Eigen::Index axis = 0;
    m.cwiseAbs().maxCoeff(&axis);
    return 2 * int(axis) + (m[axis] > 0 ? 1 : 0);
  };
  const auto count = [&](double least_solid) {
    SerialExecutor serial;
    return merge_regions({surface}, Joiner(surface), parted(surface, side),
                         {.budget = 0.02,
                          .cap = 0.08,
                          .page_area = 1,
                          .least_fill = 0.01,
                          .least_solid = least_solid},
                         serial)
        .regions.size();
  };
  EXPECT_EQ(count(0.6), 1U);
  EXPECT_GT(count(0.9), 1U);
}

/// A tube in two halves, rolled out: both stretches of their border are as long.
struct Tube {
  SegmentationMesh surface;
  std::array<MappedRegion, 2> halves = {};
};

Tube halved_tube(double height, const Vec3& offset = Vec3::Zero(), double scale = 1) {
  TriMesh mesh = shapes::cylinder(24, 17, 1, height);
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  std::vector<Vec2> flat;
  for (Vec3& p : mesh.positions) {
    flat.emplace_back(std::atan2(p.y(), p.x()), p.z());
    p = scale * (turn * p) + offset;
  }
  Tube tube{without_creases(mesh)};
  const double unit = std::sqrt(1 / (2 * M_PI * height));  // of the surface, whose area is 1
  for (Index t = 0; t < tube.surface.face_count(); ++t) {
    CornerUv uv;
    for (std::size_t i = 0; i < 3; ++i) uv[i] = flat[std::size_t(mesh.faces[std::size_t(t)][i])];
    const bool is_upper = t % 48 < 24;
    for (Vec2& p : uv) {
      if (is_upper ? p.x() < -1.5 : p.x() > 1.5) p.x() += is_upper ? 2 * M_PI : -2 * M_PI;
      p *= unit;
    }
    MappedRegion& half = tube.halves[is_upper ? 0 : 1];
    half.faces.push_back(t);
    half.uv.push_back(uv);
    half.area += tube.surface.area(t);
  }
  return tube;
}

Joined joined(const Tube& tube, const TestRules& trial) {
  const std::vector<char> open(tube.surface.length.size(), 0);
  return Joiner(tube.surface).join(tube.halves[0], tube.halves[1], open, 1, trial);
}

TEST(Join, SlitsATubeAtTheSamePlaceWhereverItLies) {
  const std::vector<Index> slit = joined(halved_tube(2), {}).slit;
  EXPECT_EQ(slit.size(), 2U * 17);
  for (const double scale : {1e-6, 0.3, 7.0, 1e6})
    for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(3, -5, 7), Vec3(1e3, 1e2, -1e3)})
      EXPECT_EQ(joined(halved_tube(2, scale * offset, scale), {}).slit, slit)
          << scale << ' ' << offset.transpose();
}

/// Laid over each other, the stretches of a long tube miss by half its girth: .16 of the border's
/// length, but .4 of the root of the area.
TEST(Join, TriesAlongBothStretchesOnlyWhatMayMeetThere) {
  const Tube tube = halved_tube(10);
  FailedTrials failures;
  const Joined both = joined(tube, {.memory = &failures});
  EXPECT_EQ(both.verdict, Verdict::sound);  // along one
  EXPECT_EQ(both.slit.size(), 2U * 17);
  const std::vector<char> open(tube.surface.length.size(), 0);
  EXPECT_FALSE(failures.find(trial_key(open, {}, both.region), 1));
}

/// A flat ring, and a wall down from its inner edge, rolled out along its first line.
TEST(Join, TriesNoWallWithThePlateAroundIt) {
  const Index around = 24;
  const SegmentationMesh surface =
      without_creases(shapes::mapped_grid(around, 8, shapes::Wrap::first, [](double u, double v) {
        const double r = std::max(1 - 1.6 * v, 0.2), z = std::min(0.5 - v, 0.0);
        const double angle = 2 * M_PI * u;
        return Vec3(r * std::cos(angle), r * std::sin(angle), z);
      }));
  const auto column = [&](Index t) { return t / 2 % around; };
  std::vector<char> open(surface.length.size(), 0);
  std::array<MappedRegion, 2> parts;  // the plate, the wall
  for (Index t = 0; t < surface.face_count(); ++t) {
    const bool is_wall = t >= surface.face_count() / 2;
    CornerUv uv;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index h = 3 * t + Index(i), twin = surface.halfedges.twin[std::size_t(h)];
      const Vec3& p = surface.mesh.positions[std::size_t(surface.mesh.faces[std::size_t(t)][i])];
      double angle = std::atan2(p.y(), p.x());
      if (angle < -1e-9 || (angle < 1 && column(t) == around - 1)) angle += 2 * M_PI;
      uv[i] = is_wall ? Vec2(angle * p.head<2>().norm(), p.z()) : Vec2(p.head<2>());
      const bool is_slit =
          is_wall && twin != kNoTwin && std::abs(column(t) - column(face_of(twin))) == around - 1;
      open[std::size_t(h)] = is_slit ? 1 : 0;
    }
    MappedRegion& part = parts[is_wall ? 1 : 0];
    part.faces.push_back(t);
    part.uv.push_back(uv);
    part.area += surface.area(t);
  }
  const Joined joined = Joiner(surface).join(parts[0], parts[1], open, 1, {});
  EXPECT_FALSE(joined.region.is_sound);
  EXPECT_TRUE(joined.region.faces.empty());
  EXPECT_TRUE(joined.slit.empty());  // the edge of a hole is one stretch
}

}  // namespace
}  // namespace unwrapd::segment
