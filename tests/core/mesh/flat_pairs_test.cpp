#include "core/mesh/flat_pairs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/weld.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

std::vector<HalfedgePair> pairs_of(const TriMesh& mesh) {
  const std::vector<Triangle> welded = renumber(mesh.faces, weld(mesh.positions));
  return flat_pairs(mesh.positions, welded, inspect_areas(mesh, welded).of);
}

/// A floor of 4 by 4 squares; a wall stands on its middle row, at an angle in degrees.
TriMesh floor_and_wall(double angle) {
  const double turn = angle * std::numbers::pi / 180;
  const TriMesh floor = grid(4, 4);
  const double row = floor.positions[10].y();
  TriMesh wall = floor;
  for (Vec3& p : wall.positions) p = {p.x(), row + p.y() * std::cos(turn), p.y() * std::sin(turn)};
  return merged(std::array{floor, wall});
}

/// The twins of the floor's faces across the row on which the wall stands.
std::vector<HalfedgePair> across_the_row() {
  const TriMesh floor = grid(4, 4);
  const std::vector<Index> twin = build_halfedges(floor.faces, floor.vertex_count()).twin;
  const double row = floor.positions[10].y();
  std::vector<HalfedgePair> pairs;
  for (Index h = 0; h < static_cast<Index>(twin.size()); ++h) {
    const auto on_row = [&](Index v) { return floor.positions[v].y() == row; };
    if (on_row(start_of(floor.faces, h)) && on_row(end_of(floor.faces, h)) && h < twin[h])
      pairs.push_back({h, twin[h]});
  }
  return pairs;
}

TEST(FlatPairs, AreTheFloorUnderAWallHoweverItLies) {
  ASSERT_EQ(across_the_row().size(), 4U);
  for (const double angle : {90.0, 120.0, 60.0, 45.0})
    for (const double scale : {1.0, 1e-3, 1e6, 1e-150}) {
      TriMesh mesh = floor_and_wall(angle);
      const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, -1).normalized());
      for (Vec3& p : mesh.positions) p = scale * (turn * p + Vec3(3, 0, -5));
      EXPECT_EQ(pairs_of(mesh), across_the_row()) << angle << " at " << scale;
    }
}

TEST(FlatPairs, AreNotThereWhereTwoFacesAreAsFlat) {
  EXPECT_TRUE(pairs_of(floor_and_wall(20)).empty());
  EXPECT_TRUE(pairs_of(floor_and_wall(0)).empty());
}

TEST(FlatPairs, AreNotThereAtCreasesNorWhereNoMoreThanTwoFacesMeet) {
  EXPECT_TRUE(pairs_of(three_faces_at_an_edge()).empty());
  EXPECT_TRUE(pairs_of(grid(5, 5)).empty());
  EXPECT_TRUE(pairs_of(cube(1)).empty());
}

TEST(FlatPairs, RunInOppositeDirections) {
  TriMesh mesh = floor_and_wall(90);
  for (std::size_t t = 0; t < 16; ++t) std::swap(mesh.faces[t][1], mesh.faces[t][2]);
  EXPECT_TRUE(pairs_of(mesh).empty());
}

/// Two coplanar faces at an edge, and others between 60 and 120 degrees from both.
TriMesh fan(int faces) {
  TriMesh mesh{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  for (int k = 2; k < faces; ++k) {
    const double turn = std::numbers::pi * (1 + double(k) / faces) / 3;
    mesh.faces.push_back({k % 2, 1 - k % 2, mesh.vertex_count()});
    mesh.positions.emplace_back(std::cos(turn), std::sin(turn), 0);
  }
  return mesh;
}

TEST(FlatPairs, AreSoughtAmongNoMoreThan64Faces) {
  EXPECT_EQ(pairs_of(fan(64)), (std::vector<HalfedgePair>{{0, 3}}));
  EXPECT_TRUE(pairs_of(fan(65)).empty());
}

}  // namespace
}  // namespace unwrapd
