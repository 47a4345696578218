#include "core/charts/cut.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/edges.hpp"
#include "core/mesh/topology.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::charts {
namespace {

using namespace shapes;

struct Cut {
  Halfedges before, after;
  Component shape;      ///< afterwards
  Index cut_edges = 0;  ///< how many were opened
  double length = 0;
};

Cut cut(const TriMesh& mesh) {
  Cut c{build_halfedges(mesh.faces, mesh.vertex_count()), {}, {}};
  c.after = c.before;
  cut_to_disk(mesh, c.after);
  const Topology shape = topology(corner_vertices(c.after).faces, c.after);
  EXPECT_EQ(shape.components.size(), 1U);
  c.shape = shape.components.front();
  for (Index h = 0; h < Index(c.after.twin.size()); ++h) {
    if (c.after.twin[h] == c.before.twin[h]) continue;
    EXPECT_EQ(c.after.twin[h], kNoTwin);
    EXPECT_EQ(c.after.twin[c.before.twin[h]], kNoTwin);
    if (h > c.before.twin[h]) continue;
    ++c.cut_edges;
    c.length +=
        (mesh.positions[end_of(mesh.faces, h)] - mesh.positions[start_of(mesh.faces, h)]).norm();
  }
  return c;
}

/// A mesh without some of its faces: holes where they were.
TriMesh without(TriMesh mesh, std::vector<std::size_t> faces) {
  std::sort(faces.rbegin(), faces.rend());
  for (std::size_t t : faces) mesh.faces.erase(mesh.faces.begin() + long(t));
  return mesh;
}

TEST(Cut, OpensClosedSurfacesOfEveryGenus) {
  for (const TriMesh& mesh :
       {cube(0), sphere(0), sphere(3), torus(9, 6), torus(3, 3), pierced_bar(1), pierced_bar(2),
        pierced_bar(7), shuffled(torus(8, 8), 2)}) {
    const Cut c = cut(mesh);
    EXPECT_EQ(c.shape.genus, 0);
    EXPECT_EQ(c.shape.boundaries, 1);
    EXPECT_GE(c.cut_edges, 2);
  }
}

TEST(Cut, OpensTheTetrahedron) {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                     {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const Cut c = cut(mesh);
  EXPECT_EQ(c.shape.boundaries, 1);
  EXPECT_EQ(c.cut_edges, 2);
}

TEST(Cut, KeepsHolesAndCutsOnlyHandles) {
  for (const TriMesh& mesh : {torus(12, 10), pierced_bar(3)}) {
    const TriMesh holed = without(mesh, {0, 9, 10, 40});
    const Cut c = cut(holed);
    EXPECT_EQ(c.shape.genus, 0);
    EXPECT_GE(c.shape.boundaries, 1);
    EXPECT_LE(c.cut_edges, cut(mesh).cut_edges + 6);
  }
}

TEST(Cut, LeavesDisksAndRingsAlone) {
  for (const TriMesh& mesh : {grid(3, 3), annulus(8, 2), cylinder(6, 2), sphere_cap(6, 2)})
    EXPECT_EQ(cut(mesh).cut_edges, 0);
}

TEST(Cut, OfATorusIsAboutAsShortAsItsTwoShortestLoops) {
  const double tube = 0.3, inner = kTurn * (1 - tube), around_tube = kTurn * tube;
  const Cut c = cut(torus(48, 16, 1, tube));
  EXPECT_LT(c.length, 1.6 * (inner + around_tube));
}

TEST(Cut, OfAClosedSphereReachesFromPoleToPole) {
  const Cut c = cut(sphere(4));
  EXPECT_GT(c.length, 0.9 * kTurn / 2);
  EXPECT_LT(c.length, 1.3 * kTurn / 2);
}

TEST(Cut, HasNoDanglingBranchWhenThereAreHandles) {
  for (const TriMesh& mesh : {torus(10, 8), pierced_bar(4), shuffled(pierced_bar(5), 1)}) {
    const Cut c = cut(mesh);
    std::map<Index, int> degree;
    for (Index h = 0; h < Index(c.after.twin.size()); ++h)
      if (c.after.twin[h] == kNoTwin) ++degree[start_of(mesh.faces, h)];
    for (const auto& [vertex, count] : degree) EXPECT_GE(count, 2) << vertex;
  }
}

}  // namespace
}  // namespace unwrapd::charts
