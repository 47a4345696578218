#include "core/solve/maps/boundary_shape.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/measure/distortion.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::maps {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

std::vector<TriMesh> disks() {
  return {shapes::sphere_cap(24, 8, 1.5), shapes::random_disk(12, 3), shapes::grid(9, 4, 3, 1),
          shapes::annulus(20, 4),         shapes::cylinder(16, 6),    shapes::cone(3, 2)};
}

/// The arc on the surface from a boundary vertex of the loop to the next.
std::vector<double> sides(const Disk& disk, const std::vector<HardConstraint>& points) {
  std::vector<double> length;
  for (std::size_t k = 0; k < points.size(); ++k)
    length.push_back((disk.positions[std::size_t(points[(k + 1) % points.size()].vertex)] -
                      disk.positions[std::size_t(points[k].vertex)])
                         .norm());
  return length;
}

double enclosed_area(const std::vector<HardConstraint>& points) {
  double sum = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec2 &a = points[k].at, &b = points[(k + 1) % points.size()].at;
    sum += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return sum;
}

TEST(BoundaryShape, PutsEveryVertexOfTheLongestLoopOnTheCircleByArcLength) {
  for (const TriMesh& mesh : disks()) {
    const OwnedDisk d = disk_of(mesh);
    const auto points = boundary_points(d.disk, BoundaryShape::circle);
    ASSERT_EQ(points.size(), d.disk.loops.front().size());
    const std::vector<double> side = sides(d.disk, points);
    const double perimeter = std::accumulate(side.begin(), side.end(), 0.0);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 &a = points[k].at, &b = points[(k + 1) % points.size()].at;
      EXPECT_NEAR(std::numbers::pi * a.squaredNorm(), 1, 1e-12);  // UV area = 3D area
      const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      const double wanted = shapes::kTurn * side[k] / perimeter;
      EXPECT_NEAR(turn, wanted > shapes::kTurn / 2 ? wanted - shapes::kTurn : wanted, 1e-9);
    }
  }
}

TEST(BoundaryShape, FillsTheSquareToItsCorners) {
  for (const TriMesh& mesh : disks()) {
    const OwnedDisk d = disk_of(mesh);
    const auto points = boundary_points(d.disk, BoundaryShape::square);
    ASSERT_EQ(points.size(), d.disk.loops.front().size());
    for (const HardConstraint& p : points) EXPECT_EQ(p.at.lpNorm<Eigen::Infinity>(), 0.5);
    EXPECT_NEAR(enclosed_area(points), points.size() == 3 ? 0.5 : 1, 1e-12);
  }
}

TEST(BoundaryShape, StretchesEverySideOfTheSquareEvenly) {
  for (const TriMesh& mesh : disks()) {
    const OwnedDisk d = disk_of(mesh);
    const auto points = boundary_points(d.disk, BoundaryShape::square);
    const std::vector<double> side = sides(d.disk, points);
    const auto is_corner = [](const Vec2& p) { return p.cwiseAbs() == Vec2(0.5, 0.5); };
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      if (is_corner(points[k + 1].at)) continue;  // the same side before and after k + 1
      const double before = (points[k + 1].at - points[k].at).norm();
      const double after = (points[(k + 2) % points.size()].at - points[k + 1].at).norm();
      EXPECT_NEAR(before * side[(k + 1)], after * side[k], 1e-9);
    }
  }
}

TEST(BoundaryShape, KeepsTheCornersOfASheet) {
  for (unsigned seed : {1U, 2U, 3U, 4U}) {  // wherever its boundary is told to begin
    const OwnedDisk d = disk_of(shapes::shuffled(shapes::grid(6, 6), seed));
    for (const HardConstraint& p : boundary_points(d.disk, BoundaryShape::square)) {
      const Vec3& at = d.disk.positions[std::size_t(p.vertex)];
      const bool corner = at.head<2>().cwiseAbs().minCoeff() > 0.499;
      EXPECT_EQ(corner, p.at.cwiseAbs().minCoeff() == 0.5);
    }
  }
}

TEST(BoundaryShape, TellsWhenTheSquareFlattensATriangle) {
  const auto flattens = [](const TriMesh& mesh) {
    const OwnedDisk d = disk_of(mesh);
    return flattens_a_triangle(d.disk, boundary_points(d.disk, BoundaryShape::square));
  };
  EXPECT_FALSE(flattens(shapes::grid(6, 6)));
  EXPECT_FALSE(flattens(shapes::sphere_cap(24, 8, 1.5)));
  TriMesh ear = shapes::grid(6, 6);
  ear.positions.emplace_back(0.25, -0.1, 0);  // on the lower side, over one edge
  ear.faces.push_back({1, 49, 2});
  EXPECT_TRUE(flattens(ear));
  TriMesh flap = ear;  // the same with a vertex inside the ear: no face has three on the side
  flap.faces.back() = {1, 49, 50};
  flap.positions.emplace_back(0.25, -0.03, 0);
  flap.faces.push_back({49, 2, 50});
  flap.faces.push_back({2, 1, 50});
  EXPECT_TRUE(flattens(flap));
}

TEST(BoundaryShape, HasItsCornersOnRealMeshesToo) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for (const char* name : {"Cow_dABF", "Balls"}) {
    const OwnedDisk d = disk_of(read_obj(test_data() / "paper" / (std::string(name) + ".obj")));
    EXPECT_NEAR(enclosed_area(boundary_points(d.disk, BoundaryShape::square)), 1, 1e-12);
  }
}

TEST(ConvexMap, KeepsAGivenBoundaryAndDoesNotFlip) {
  for (const TriMesh& mesh : {shapes::sphere_cap(24, 8, 1.5), shapes::cone(16, 5)}) {
    const OwnedDisk d = disk_of(mesh);
    for (BoundaryShape shape : {BoundaryShape::circle, BoundaryShape::square}) {
      const auto points = boundary_points(d.disk, shape);
      for (const UvMap& uv : {tutte_map(d.disk, points), mean_value_map(d.disk, points)}) {
        for (const HardConstraint& p : points) EXPECT_EQ(uv[std::size_t(p.vertex)], p.at);
        EXPECT_EQ(measure::distortion_sums(d.disk.rest, d.disk.faces, uv).flipped, 0);
        EXPECT_NEAR(measure::uv_area(d.disk.rest, d.disk.faces, uv), enclosed_area(points), 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace unwrapd::solve::maps
