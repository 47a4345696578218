#include "core/mesh/topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

struct Known {
  const char* name;
  TriMesh mesh;
  Index euler, boundaries, genus;
};

std::vector<Known> known_shapes() {
  return {{"grid", grid(5, 3), 1, 1, 0},           {"annulus", annulus(9, 2), 0, 2, 0},
          {"cylinder", cylinder(7, 3), 0, 2, 0},   {"half cylinder", half_cylinder(6, 2), 1, 1, 0},
          {"cone", cone(8, 3), 1, 1, 0},           {"cone sector", cone_sector(8, 3), 1, 1, 0},
          {"cap", sphere_cap(8, 3), 1, 1, 0},      {"cube", cube(1), 2, 0, 0},
          {"sphere", sphere(2), 2, 0, 0},          {"torus", torus(8, 6), 0, 0, 1},
          {"two holes", pierced_bar(2), -2, 0, 2}, {"five holes", pierced_bar(5), -8, 0, 5},
          {"random", random_disk(7, 3), 1, 1, 0}};
}

/// V - E + F with sets, of a mesh that is one manifold piece.
Index brute_force_euler(const TriMesh& mesh) {
  std::set<Index> vertices;
  std::set<std::pair<Index, Index>> edges;
  for (const auto& [a, b, c] : mesh.faces) {
    vertices.insert({a, b, c});
    edges.insert({std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)});
  }
  return Index(vertices.size()) - Index(edges.size()) + mesh.face_count();
}

Topology topology_of(const TriMesh& mesh) {
  const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
  return topology(corner_vertices(halfedges).faces, halfedges);
}

TEST(Topology, KnownShapesHaveTheirEulerCharacteristicBoundariesAndGenus) {
  for (const Known& known : known_shapes()) {
    const Topology shape = topology_of(known.mesh);
    ASSERT_EQ(shape.components.size(), 1U) << known.name;
    const Component& c = shape.components.front();
    EXPECT_EQ(c.euler, known.euler) << known.name;
    EXPECT_EQ(c.euler, brute_force_euler(known.mesh)) << known.name;
    EXPECT_EQ(c.boundaries, known.boundaries) << known.name;
    EXPECT_EQ(c.genus, known.genus) << known.name;
    EXPECT_EQ(c.vertices, known.mesh.vertex_count()) << known.name;
    EXPECT_EQ(c.faces, known.mesh.face_count()) << known.name;
    EXPECT_EQ(c.is_disk(), known.boundaries > 0) << known.name;
  }
}

TEST(Topology, NumberingOfVerticesFacesAndCornersDoesNotMatter) {
  for (const Known& known : known_shapes()) {
    for (unsigned seed : {1U, 2U, 3U}) {
      const Component c = topology_of(shuffled(known.mesh, seed)).components.at(0);
      EXPECT_EQ(c.euler, known.euler) << known.name;
      EXPECT_EQ(c.boundaries, known.boundaries) << known.name;
      EXPECT_EQ(c.genus, known.genus) << known.name;
    }
  }
}

TEST(Topology, ComponentsAreCountedApartInTheOrderOfTheirFirstFace) {
  const std::vector<TriMesh> parts{torus(5, 4), grid(2, 2), pierced_bar(3), annulus(6, 1)};
  const Topology shape = topology_of(merged(parts));
  ASSERT_EQ(shape.components.size(), 4U);
  EXPECT_EQ(shape.components[0].genus, 1);
  EXPECT_TRUE(shape.components[1].is_disk());
  EXPECT_EQ(shape.components[2].genus, 3);
  EXPECT_EQ(shape.components[3].boundaries, 2);
  EXPECT_TRUE(std::is_sorted(shape.component_of.begin(), shape.component_of.end()));
}

TEST(Topology, NoFacesAreNoComponents) { EXPECT_TRUE(topology_of({}).components.empty()); }

TEST(CornerVertices, GiveBackTheVerticesOfAManifoldMesh) {
  for (const Known& known : known_shapes()) {
    const Halfedges h = build_halfedges(known.mesh.faces, known.mesh.vertex_count());
    const CornerVertices corners = corner_vertices(h);
    EXPECT_EQ(corners.count, known.mesh.vertex_count()) << known.name;
    std::map<Index, Index> to;
    for (std::size_t t = 0; t < corners.faces.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(to.try_emplace(known.mesh.faces[t][i], corners.faces[t][i]).first->second,
                  corners.faces[t][i]);
  }
}

TEST(CornerVertices, AreNumberedByFirstUse) {
  const TriMesh mesh = shuffled(torus(6, 5), 4);
  const CornerVertices corners = corner_vertices(build_halfedges(mesh.faces, mesh.vertex_count()));
  Index next = 0;
  for (const Triangle& face : corners.faces) {
    for (Index v : face) {
      EXPECT_LE(v, next);
      next = std::max(next, v + 1);
    }
  }
  EXPECT_EQ(next, corners.count);
}

TEST(CornerVertices, TakeABowTieApart) {
  const TriMesh mesh = bow_tie();
  const Halfedges h = build_halfedges(mesh.faces, mesh.vertex_count());
  EXPECT_EQ(corner_vertices(h).count, 6);
  EXPECT_EQ(topology_of(mesh).components.size(), 2U);
}

}  // namespace
}  // namespace unwrapd
