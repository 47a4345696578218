#include "core/mesh/seams.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

struct Prepared {
  Surface surface;
  std::vector<Triangle> welded;
  FaceStates states;
};

Prepared prepared(Surface surface) {
  Prepared p{std::move(surface), {}, {}};
  p.welded = renumber(p.surface.mesh.faces, weld(p.surface.mesh.positions));
  p.states = inspect_faces(p.surface.mesh, p.welded);
  return p;
}

Pairing by_place(const Prepared& p) { return pair_welded(p.surface, p.welded, p.states); }

Pairing kept(const Prepared& p) { return pair_keeping_seams(p.surface, p.welded, p.states); }

long open_count(const Pairing& pairing) {
  return std::count(pairing.halfedges.twin.begin(), pairing.halfedges.twin.end(), kNoTwin);
}

TEST(Seams, APositionIsOneVertexWhenWelded) {
  const TriMesh mesh = torus(7, 5);
  const Prepared p = prepared(surface_of(soup(mesh)));
  EXPECT_EQ(by_place(p).halfedges.twin, build_halfedges(mesh.faces, mesh.vertex_count()).twin);
  EXPECT_EQ(open_count(kept(p)), 3 * mesh.face_count());
}

TEST(Seams, ADiskStoredAsThreePrimitivesIsOneDiskAgain) {
  const TriMesh mesh = grid(6, 5);
  std::vector<Index> part;
  for (Index t = 0; t < mesh.face_count(); ++t) part.push_back(t * 3 / mesh.face_count());
  const Prepared p = prepared(in_parts(mesh, part));
  EXPECT_EQ(kept(p).halfedges.twin, build_halfedges(mesh.faces, mesh.vertex_count()).twin);
}

TEST(Seams, ACutInsideAPrimitiveStaysOpen) {
  Surface surface = surface_of(annulus(8, 2));
  TriMesh& mesh = surface.mesh;  // cut along the ray at angle 0
  const Index n = mesh.vertex_count();
  for (Index j : {0, 1, 2}) mesh.positions.push_back(mesh.positions[8 * j]);
  for (Triangle& face : mesh.faces) {
    if (std::none_of(face.begin(), face.end(), [](Index v) { return v % 8 == 7; })) continue;
    for (Index& v : face)
      if (v % 8 == 0) v = n + v / 8;
  }
  const Prepared p = prepared(surface);
  EXPECT_EQ(open_count(kept(p)), 16 + 4);
  EXPECT_EQ(open_count(by_place(p)), 16);
  surface.part.back() = 1;  // with a second primitive, too
  EXPECT_EQ(open_count(kept(prepared(surface))), 16 + 4);
}

TEST(Seams, TwoSidesOfASheetInTwoPrimitivesAreNotSewnTogether) {
  TriMesh mesh = grid(3, 3);
  const std::size_t n = mesh.faces.size();
  std::vector<Index> part(n, 0);
  for (std::size_t t = 0; t < n; ++t) {
    mesh.faces.push_back({mesh.faces[t][0], mesh.faces[t][2], mesh.faces[t][1]});
    part.push_back(1);
  }
  const Prepared p = prepared(in_parts(mesh, part));
  EXPECT_EQ(open_count(kept(p)), 24);
  EXPECT_EQ(open_count(by_place(p)), 24);
}

/// A grid with one inner edge doubled: two needles lie between its copies.
TriMesh with_collapsed_faces(bool own_vertices) {
  TriMesh mesh = grid(2, 2);
  const Index centre = 4, right = 5;
  Index copy = centre;
  if (own_vertices) {
    copy = mesh.vertex_count();
    mesh.positions.push_back(mesh.positions[centre]);
    for (Triangle& face : mesh.faces) {  // the upper half gets the copy
      const bool upper = std::any_of(face.begin(), face.end(), [](Index v) { return v > 5; });
      if (upper) std::replace(face.begin(), face.end(), centre, copy);
    }
  }
  mesh.faces.push_back({centre, right, copy});
  mesh.faces.push_back({copy, 3, centre});
  return mesh;
}

TEST(Seams, TakingACollapsedFaceOutLeavesNoTear) {
  for (bool own_vertices : {false, true}) {
    const Prepared p = prepared(surface_of(with_collapsed_faces(own_vertices)));
    for (const Pairing& pairing : {kept(p), by_place(p)}) {
      EXPECT_EQ(open_count(pairing), 8 + 6);  // the border, and the faces that are out
      for (Index h = 0; h < Index(pairing.halfedges.twin.size()); ++h) {
        const Index g = pairing.halfedges.twin[h];
        if (g == kNoTwin) continue;
        EXPECT_EQ(pairing.halfedges.twin[g], h);
        EXPECT_EQ(start_of(p.welded, g), end_of(p.welded, h));
      }
    }
  }
}

/// Eight cubes that fill a larger one, each with vertices of its own.
TriMesh packed_cubes() {
  std::vector<TriMesh> all;
  for (int k = 0; k < 8; ++k) all.push_back(moved(cube(), Vec3(k & 1, k >> 1 & 1, k >> 2 & 1)));
  return merged(all);
}

TEST(Seams, BodiesThatTouchAreNotTornApart) {
  const TriMesh mesh = packed_cubes();
  const Pairing pairing = by_place(prepared(surface_of(mesh)));
  EXPECT_EQ(pairing.halfedges.twin, build_halfedges(mesh.faces, mesh.vertex_count()).twin);
  EXPECT_EQ(pairing.split_edges, 0);
}

TEST(Seams, AFloorGoesOnUnderAWall) {
  const TriMesh floor = grid(4, 4);
  TriMesh wall = floor;  // stands on the middle row of the floor, whose vertices are at its feet
  for (Vec3& p : wall.positions) p = {p.x(), floor.positions[10].y(), p.y()};
  const Pairing pairing = by_place(prepared(surface_of(merged(std::array{floor, wall}))));
  const Halfedges alone = build_halfedges(floor.faces, floor.vertex_count());
  EXPECT_TRUE(std::equal(alone.twin.begin(), alone.twin.end(), pairing.halfedges.twin.begin()));
  EXPECT_EQ(open_count(pairing), 2 * 16);
}

TEST(Seams, VerticesOfEveryFaceTellNothingOfBodies) {
  const Pairing pairing = by_place(prepared(surface_of(soup(packed_cubes()))));
  EXPECT_GT(pairing.split_edges, 0);
}

TEST(Seams, ClosingSlitsClosesLoopsOfTwoAndNoOthers) {
  const TriMesh mesh = grid(4, 4);
  Halfedges h = build_halfedges(mesh.faces, mesh.vertex_count());
  const Halfedges whole = h;
  Index g = 0;  // the diagonal between two inner vertices
  while (start_of(mesh.faces, g) != 6 || end_of(mesh.faces, g) != 12) ++g;
  h.twin[h.twin[g]] = kNoTwin;
  h.twin[g] = kNoTwin;
  close_slits(h);
  EXPECT_EQ(h.twin, whole.twin);
  Halfedges triangle{{kNoTwin, kNoTwin, kNoTwin}};
  close_slits(triangle);
  EXPECT_EQ(triangle.twin, std::vector<Index>(3, kNoTwin));
}

std::optional<Index> one_sided(const TriMesh& mesh) {
  const Prepared p = prepared(surface_of(mesh));
  const Pairing pairing = by_place(p);
  return one_sided_component(pairing.clashes,
                             topology(corner_vertices(pairing.halfedges).faces, pairing.halfedges));
}

TEST(Seams, OnlyASurfaceThatCannotBeOrientedIsOneSided) {
  EXPECT_TRUE(one_sided(mobius_strip(9)));
  EXPECT_TRUE(one_sided(shuffled(mobius_strip(20, 3), 1)));
  EXPECT_TRUE(one_sided(merged(std::array{torus(5, 4), mobius_strip(7)})));
  EXPECT_FALSE(one_sided(three_faces_at_an_edge()));
}

TEST(Seams, RandomWindingIsNoReasonToCallASurfaceOneSided) {
  for (unsigned seed : {1U, 2U, 3U, 4U}) {
    std::mt19937 rng(seed);
    TriMesh mesh = seed % 2 == 0 ? torus(9, 8) : grid(7, 7), strip = mobius_strip(12);
    for (TriMesh* turned : {&mesh, &strip})
      for (Triangle& face : turned->faces)
        if (rng() % 2 == 0) std::swap(face[0], face[1]);
    EXPECT_FALSE(one_sided(mesh));
    EXPECT_TRUE(one_sided(strip));
  }
}

}  // namespace
}  // namespace unwrapd
