#include "core/mesh/halfedges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

Halfedges halfedges_of(const TriMesh& mesh) {
  return build_halfedges(mesh.faces, mesh.vertex_count());
}

/// The documented rule, half-edge against half-edge.
std::vector<Index> brute_force_twins(const std::vector<Triangle>& faces) {
  const auto n = static_cast<Index>(3 * faces.size());
  const auto could_pair = [&](Index g, Index h) {
    return !repeats_vertex(faces[g / 3]) && !repeats_vertex(faces[h / 3]) &&
           start_of(faces, g) == end_of(faces, h) && start_of(faces, h) == end_of(faces, g) &&
           apex_of(faces, g) != apex_of(faces, h);
  };
  const auto partners = [&](Index h) {
    std::vector<Index> found;
    for (Index g = 0; g < n; ++g)
      if (could_pair(g, h)) found.push_back(g);
    return found;
  };
  std::vector<Index> twin(static_cast<std::size_t>(n), kNoTwin);
  for (Index h = 0; h < n; ++h) {
    const std::vector<Index> mine = partners(h);
    if (mine.size() != 1) continue;
    const std::vector<Index> others = partners(mine[0]);
    const auto needs_it = [&](Index g) { return g != h && partners(g).size() == 1; };
    if (std::ranges::any_of(others, needs_it)) continue;
    twin[h] = mine[0];
    twin[mine[0]] = h;
  }
  return twin;
}

TEST(Halfedges, EqualTheBruteForcePairingOnRandomFaces) {
  std::mt19937 rng(1);
  for (int k = 0; k < 300; ++k) {
    const Index vertex_count = 3 + static_cast<Index>(rng() % 8);
    std::vector<Triangle> faces;
    while (faces.size() < rng() % 12) {
      Triangle face{};
      for (Index& v : face) v = static_cast<Index>(rng()) & 7;
      for (Index& v : face) v %= vertex_count;
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      if (std::find(faces.begin(), faces.end(), face) == faces.end()) faces.push_back(face);
    }
    EXPECT_EQ(build_halfedges(faces, vertex_count).twin, brute_force_twins(faces));
  }
}

TEST(Halfedges, OfTwoCubesOnEachOtherAreThoseOfEachCube) {
  const TriMesh lower = cube(), upper = moved(cube(), Vec3(0, 0, 1));
  TriMesh both = merged(std::array{lower, upper});
  both.faces = renumber(both.faces, weld(both.positions));
  const Halfedges own = halfedges_of(lower);
  const Halfedges twins = halfedges_of(both);
  const auto half = static_cast<std::ptrdiff_t>(own.twin.size());
  EXPECT_TRUE(std::equal(own.twin.begin(), own.twin.end(), twins.twin.begin()));
  EXPECT_TRUE(
      std::none_of(twins.twin.begin() + half, twins.twin.end(), [&](Index h) { return h < half; }));
}

TEST(Halfedges, TwinsAreMutualAndRunTheOtherWay) {
  for (const TriMesh& mesh : {grid(6, 5), torus(8, 7), sphere(2), shuffled(pierced_bar(4), 9)}) {
    const Halfedges h = halfedges_of(mesh);
    for (Index g = 0; g < Index(h.twin.size()); ++g) {
      if (h.twin[g] == kNoTwin) continue;
      EXPECT_EQ(h.twin[h.twin[g]], g);
      EXPECT_EQ(start_of(mesh.faces, g), end_of(mesh.faces, h.twin[g]));
      EXPECT_EQ(end_of(mesh.faces, g), start_of(mesh.faces, h.twin[g]));
    }
  }
}

TEST(Halfedges, AThirdFaceAtAnEdgeSplitsIt) {
  const Halfedges h = halfedges_of(three_faces_at_an_edge());
  EXPECT_EQ(std::count(h.twin.begin(), h.twin.end(), kNoTwin), 9);
}

TEST(Halfedges, TwoFacesOfOppositeWindingAreNotPaired) {
  const std::vector<Triangle> faces{{0, 1, 2}, {0, 1, 3}};
  const Halfedges h = build_halfedges(faces, 4);
  EXPECT_EQ(std::count(h.twin.begin(), h.twin.end(), kNoTwin), 6);
}

TEST(Halfedges, ADoubleSidedSheetIsTwoSheets) {
  TriMesh mesh = grid(4, 4);
  const Halfedges front = halfedges_of(mesh);
  const std::size_t n = mesh.faces.size();
  for (std::size_t t = 0; t < n; ++t)
    mesh.faces.push_back({mesh.faces[t][0], mesh.faces[t][2], mesh.faces[t][1]});
  const Halfedges both = halfedges_of(mesh);
  EXPECT_TRUE(std::equal(front.twin.begin(), front.twin.end(), both.twin.begin()));
  for (std::size_t h = 3 * n; h < 6 * n; ++h)
    EXPECT_TRUE(both.twin[h] == kNoTwin || both.twin[h] >= Index(3 * n));
  EXPECT_EQ(std::count(both.twin.begin(), both.twin.end(), kNoTwin), 32);
}

TEST(Halfedges, ManyFacesAtOneEdgeAreLeftUnpaired) {
  std::vector<Triangle> faces;
  for (Index t = 0; t < 100'000; ++t) faces.push_back({0, 1, t + 2});
  const Halfedges h = build_halfedges(faces, 100'002);
  EXPECT_EQ(std::count(h.twin.begin(), h.twin.end(), kNoTwin), 300'000);
}

TEST(BoundaryLoops, FollowOneAnotherAndHoldEveryOpenHalfedgeOnce) {
  for (const TriMesh& mesh : {grid(5, 2), annulus(9, 3), cylinder(8, 2), shuffled(grid(6, 6), 3),
                              sphere_cap(7, 3), random_disk(6, 2)}) {
    const Halfedges h = halfedges_of(mesh);
    std::vector<Index> all;
    for (const BoundaryLoop& loop : boundary_loops(mesh, h)) {
      for (std::size_t k = 0; k < loop.size(); ++k)
        EXPECT_EQ(end_of(mesh.faces, loop[k]), start_of(mesh.faces, loop[(k + 1) % loop.size()]));
      all.insert(all.end(), loop.begin(), loop.end());
    }
    std::sort(all.begin(), all.end());
    std::vector<Index> open;
    for (Index g = 0; g < Index(h.twin.size()); ++g)
      if (h.twin[g] == kNoTwin) open.push_back(g);
    EXPECT_EQ(all, open);
  }
}

TEST(BoundaryLoops, TheLongestComesFirst) {
  const TriMesh mesh = annulus(16, 2, 0.25, 1);
  const auto loops = boundary_loops(mesh, halfedges_of(mesh));
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NEAR(mesh.positions[start_of(mesh.faces, loops[0][0])].norm(), 1, 1e-12);
  EXPECT_NEAR(mesh.positions[start_of(mesh.faces, loops[1][0])].norm(), 0.25, 1e-12);
}

TEST(BoundaryLoops, OfAClosedSurfaceAreNone) {
  const TriMesh mesh = torus(6, 5);
  EXPECT_TRUE(boundary_loops(mesh, halfedges_of(mesh)).empty());
}

}  // namespace
}  // namespace unwrapd
