#include "core/mesh/orient_faces.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/mesh/halfedges.hpp"
#include "core/mesh/weld.hpp"
#include "tests/core/rounded.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using shapes::Rounded;

std::vector<char> turned_of(const TriMesh& mesh) {
  const std::vector<Triangle> faces = renumber(mesh.faces, weld(mesh.positions));
  const FaceStates states = inspect_areas(mesh, faces);
  std::vector<EdgeSide> sides =
      edge_sides(faces, [&](Index h) { return states.of[face_of(h)] == FaceState::sound; });
  sort_by_edge(sides, mesh.vertex_count());
  return faces_to_turn({mesh, faces, states, sides});
}

/// The soup of a mesh, each face wound the other way with this probability.
Rounded wound(const TriMesh& mesh, double probability, unsigned seed) {
  Rounded soup = shapes::apart(mesh);
  shapes::wind_at_random(probability, seed, soup);
  return soup;
}

std::vector<char> opposite(std::vector<char> turned) {
  for (char& t : turned) t = t == 0 ? 1 : 0;
  return turned;
}

std::vector<std::pair<std::string, TriMesh>> closed() {
  return {{"sphere", shapes::sphere(2)},
          {"cube", shapes::cube(1)},
          {"torus", shapes::torus(9, 7)},
          {"bar", shapes::pierced_bar(2)}};
}

TEST(FacesToTurn, TurnsClosedSurfacesOutward) {
  for (const auto& [name, mesh] : closed())
    for (const unsigned seed : {1U, 2U, 3U, 4U}) {
      const Rounded soup = wound(mesh, 0.5, seed);
      EXPECT_EQ(turned_of(soup.mesh), soup.is_turned) << name;
      const Rounded far = {shapes::moved(soup.mesh, 1e-3, {1e4, -1e5, 3}), {}};
      EXPECT_EQ(turned_of(far.mesh), soup.is_turned) << name;
    }
}

TEST(FacesToTurn, KeepsTheWindingOfMostFaces) {
  std::vector<std::pair<std::string, TriMesh>> all = closed();
  all.emplace_back("grid", shapes::grid(8, 6));
  all.emplace_back("annulus", shapes::annulus(20, 3));
  for (const auto& [name, mesh] : all) {
    const Rounded few = wound(mesh, 0.1, 5), most = wound(mesh, 0.9, 5);
    EXPECT_EQ(turned_of(few.mesh), few.is_turned) << name;
    EXPECT_EQ(turned_of(most.mesh), opposite(most.is_turned)) << name;  // inside out, as it came
  }
}

TEST(FacesToTurn, MakesOpenSurfacesAgree) {
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    const Rounded soup = wound(shapes::grid(9, 7), 0.5, seed);
    const auto count = std::count(soup.is_turned.begin(), soup.is_turned.end(), 1);
    EXPECT_EQ(turned_of(soup.mesh), 2 * count <= 126 ? soup.is_turned : opposite(soup.is_turned));
  }
}

TEST(FacesToTurn, JudgesEachComponentAlone) {
  const TriMesh cube = shapes::cube(1);
  TriMesh inside_out = shapes::moved(cube, 0.5, {3, 0, 0});
  for (Triangle& face : inside_out.faces) std::swap(face[1], face[2]);
  Rounded both = shapes::apart(shapes::together(cube, inside_out));
  std::swap(both.mesh.faces[7][1], both.mesh.faces[7][2]);
  std::vector<char> expected(both.mesh.faces.size(), 0);
  expected[7] = 1;
  EXPECT_EQ(turned_of(both.mesh), expected);
}

TEST(FacesToTurn, LeavesConsistentAndOneSidedSurfacesAlone) {
  for (const auto& [name, mesh] : closed()) {
    EXPECT_TRUE(turned_of(mesh).empty()) << name;
    EXPECT_TRUE(turned_of(wound(mesh, 1, 1).mesh).empty()) << name;
  }
  EXPECT_TRUE(turned_of(shapes::mobius_strip(12)).empty());
  EXPECT_TRUE(turned_of(wound(shapes::mobius_strip(12), 0.5, 3).mesh).empty());
  EXPECT_TRUE(turned_of(shapes::thin_wall(3, 0)).empty());  // both sides of a sheet
  EXPECT_TRUE(turned_of(shapes::three_faces_at_an_edge()).empty());
}

}  // namespace
}  // namespace unwrapd
