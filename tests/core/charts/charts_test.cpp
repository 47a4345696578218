#include "core/charts/charts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

#include "core/base/error.hpp"
#include "core/measure/seam_length.hpp"
#include "core/mesh/edges.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::charts {
namespace {

using namespace shapes;

/// Counts by brute force, from the faces alone: what a chart has to be.
void expect_disk(const Chart& chart, const std::string& name) {
  std::map<std::pair<Index, Index>, int> sides;
  std::set<Index> vertices;
  for (const Triangle& face : chart.mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      vertices.insert(face[i]);
      ++sides[{face[i], face[(i + 1) % 3]}];
    }
  }
  Index edges = 0, open = 0;
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1) << name;
    const bool twin = sides.contains({side.second, side.first});
    open += !twin;
    edges += !twin || side.first < side.second;
  }
  const auto loop_count = static_cast<Index>(chart.loops.size());
  EXPECT_GE(loop_count, 1) << name;
  EXPECT_EQ(Index(vertices.size()), chart.mesh.vertex_count()) << name;
  EXPECT_EQ(Index(vertices.size()) - edges + chart.mesh.face_count(), 2 - loop_count) << name;
  Index in_loops = 0;
  for (const BoundaryLoop& loop : chart.loops) {
    EXPECT_GE(loop.size(), 3U) << name;
    in_loops += static_cast<Index>(loop.size());
  }
  EXPECT_EQ(in_loops, open) << name;
  const Halfedges again = build_halfedges(chart.mesh.faces, chart.mesh.vertex_count());
  EXPECT_EQ(again.twin, chart.halfedges.twin) << name;
  EXPECT_EQ(topology(chart.mesh.faces, chart.halfedges).components.size(), 1U) << name;
}

/// Every chart is a disk and shows the surface's faces where they are; every face is somewhere
/// once.
void expect_valid(const Surface& surface, const Charts& charts, const std::string& name) {
  std::vector<int> seen(surface.mesh.faces.size(), 0);
  for (Index t : charts.set_aside) ++seen[t];
  EXPECT_EQ(charts.set_aside.size(), charts.repeats.size());
  for (const Chart& chart : charts.charts) {
    expect_disk(chart, name);
    ASSERT_EQ(chart.face_source.size(), chart.mesh.faces.size()) << name;
    for (std::size_t t = 0; t < chart.face_source.size(); ++t) {
      ++seen[chart.face_source[t]];
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(chart.mesh.positions[chart.mesh.faces[t][i]],
                  surface.mesh.positions[surface.mesh.faces[chart.face_source[t]][i]])
            << name;
    }
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; })) << name;
}

Charts checked_charts(const TriMesh& mesh, SeamMode seams = SeamMode::automatic) {
  const Surface surface = surface_of(mesh);
  Charts charts = make_charts(surface, seams);
  expect_valid(surface, charts, "");
  return charts;
}

Index repair_count(const Charts& charts, RepairKind kind) {
  for (const Repair& repair : charts.repairs)
    if (repair.kind == kind) return repair.count;
  return 0;
}

TEST(Charts, EveryShapeBecomesDisksInEverySeamMode) {
  const std::vector<TriMesh> meshes{grid(4, 3),
                                    annulus(9, 2),
                                    cylinder(8, 3),
                                    half_cylinder(6, 4),
                                    torus(9, 7),
                                    cube(0),
                                    cube(2),
                                    sphere(0),
                                    sphere(3),
                                    pierced_bar(1),
                                    cone(7, 3),
                                    pierced_bar(6),
                                    sphere_cap(9, 4),
                                    bow_tie(),
                                    three_faces_at_an_edge(),
                                    soup(cube(1)),
                                    random_disk(9, 5),
                                    shuffled(pierced_bar(3), 2),
                                    soup(pierced_bar(2))};
  for (const TriMesh& mesh : meshes)
    for (SeamMode seams : {SeamMode::automatic, SeamMode::keep, SeamMode::none})
      checked_charts(mesh, seams);
}

/// Triangles at random between the points of a small lattice, each of which has two vertices.
TriMesh tangle(unsigned seed) {
  std::mt19937 rng(seed);
  TriMesh mesh;
  for (int k = 0; k < 24; ++k) mesh.positions.emplace_back(k % 3, k / 3 % 2, k / 6 % 2);
  while (mesh.faces.size() < 4 + seed % 12) {
    Triangle face{};
    for (Index& v : face) v = static_cast<Index>(rng() % 24);
    if (face[0] % 12 != face[1] % 12 && face[1] % 12 != face[2] % 12 &&
        face[2] % 12 != face[0] % 12)
      mesh.faces.push_back(face);
  }
  return mesh;
}

TEST(Charts, SheetsThatMeetAtEdgesAtRandomBecomeDisks) {
  int answered = 0;
  for (unsigned seed = 0; seed < 4000; ++seed) {
    std::mt19937 rng(seed);
    const TriMesh mesh = tangle(seed);
    std::vector<Index> part(mesh.faces.size(), 0);
    if (seed % 2 == 0)
      for (Index& p : part) p = static_cast<Index>(rng() % 2);
    const Surface surface = in_parts(mesh, part);
    for (SeamMode seams : {SeamMode::automatic, SeamMode::keep, SeamMode::none}) try {
        expect_valid(surface, make_charts(surface, seams), std::to_string(seed));
        ++answered;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_orientable) << seed;
      }
  }
  EXPECT_GT(answered, 3000);
}

TEST(Charts, WhatIsADiskStaysAsItIs) {
  const TriMesh mesh = random_disk(8, 1);
  const Charts charts = checked_charts(mesh);
  ASSERT_EQ(charts.charts.size(), 1U);
  EXPECT_EQ(charts.charts[0].mesh.vertex_count(), mesh.vertex_count());
  EXPECT_TRUE(charts.repairs.empty());
  EXPECT_FALSE(charts.input.welded);
}

TEST(Charts, HolesAreNotCut) {
  const Charts charts = checked_charts(annulus(12, 2));
  EXPECT_EQ(charts.charts.at(0).loops.size(), 2U);
  EXPECT_EQ(repair_count(charts, RepairKind::cut_to_disk), 0);
}

TEST(Charts, HandlesAreCutThoughThereIsAHole) {
  TriMesh mesh = torus(9, 8);
  mesh.faces.erase(mesh.faces.begin() + 20);
  EXPECT_EQ(repair_count(checked_charts(mesh), RepairKind::cut_to_disk), 1);
}

TEST(Charts, TilesOfAFloorGoOnUnderAWall) {
  const TriMesh tile = grid(3, 3);
  TriMesh wall = tile;  // all three meet at the tiles' common border
  for (Vec3& p : wall.positions) p = {1, p.x(), p.y()};
  const TriMesh all = merged(std::array{tile, moved(tile, Vec3(1, 0, 0)), wall});
  EXPECT_EQ(make_charts(surface_of(all), SeamMode::none).charts.size(), 2U);
}

TEST(Charts, AMoebiusStripIsRefused) {
  for (SeamMode seams : {SeamMode::automatic, SeamMode::keep, SeamMode::none}) {
    try {
      make_charts(surface_of(mobius_strip(12)), seams);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::not_orientable);
    }
  }
}

/// The same vertices for all faces of a group, others for other groups; one primitive.
TriMesh cut_apart(const TriMesh& mesh, const std::vector<Index>& group) {
  return in_parts(mesh, group).mesh;
}

TEST(Charts, ACutThatSomeoneMadeIsKept) {
  for (const TriMesh& closed : {sphere(3), torus(12, 9)}) {
    const TriMesh opened = checked_charts(closed).charts.at(0).mesh;
    const Charts charts = checked_charts(opened);
    EXPECT_FALSE(charts.input.welded);
    EXPECT_EQ(charts.input.boundaries, 1);
    EXPECT_EQ(charts.charts.at(0).mesh.faces, opened.faces);
    const Charts welded = checked_charts(opened, SeamMode::none);
    EXPECT_TRUE(welded.input.welded);
    EXPECT_EQ(welded.input.boundaries, 0);
    EXPECT_EQ(repair_count(welded, RepairKind::cut_to_disk), 1);
  }
}

TEST(Charts, TwoHalvesOfASphereAreKeptAndSixSidesOfACubeAreWelded) {
  const TriMesh ball = sphere(2), box = cube(2);
  std::vector<Index> half, side;
  for (const Triangle& face : ball.faces)
    half.push_back(ball.positions[face[0]].z() + ball.positions[face[1]].z() +
                       ball.positions[face[2]].z() >
                   0);
  for (Index t = 0; t < box.face_count(); ++t) side.push_back(t / 32);
  EXPECT_EQ(checked_charts(cut_apart(ball, half)).charts.size(), 2U);
  const Charts charts = checked_charts(cut_apart(box, side));
  EXPECT_TRUE(charts.input.welded);
  EXPECT_EQ(charts.input.components, 1);
}

TEST(Charts, FlatShadedFacesAreWelded) {
  for (const TriMesh& mesh : {grid(2, 1), cube(0), sphere(2), random_disk(5, 1)}) {
    const Charts charts = checked_charts(soup(mesh));
    EXPECT_TRUE(charts.input.welded);
    EXPECT_EQ(charts.input.components, 1);
  }
}

TEST(Charts, WhatIsWrongWithAMeshIsCounted) {
  TriMesh mesh = merged(std::array{three_faces_at_an_edge(), moved(torus(6, 5), {9, 0, 0})});
  mesh.faces.push_back(mesh.faces[1]);
  mesh.faces.push_back({0, 0, 2});
  mesh.faces.push_back(mesh.faces[2]);
  const Charts charts = checked_charts(mesh);
  EXPECT_EQ(repair_count(charts, RepairKind::degenerate_faces_set_aside), 1);
  EXPECT_EQ(repair_count(charts, RepairKind::duplicate_faces_set_aside), 2);
  EXPECT_EQ(repair_count(charts, RepairKind::non_manifold_edges_split), 1);
  EXPECT_EQ(repair_count(charts, RepairKind::cut_to_disk), 1);
  EXPECT_EQ(charts.input.genus, 1);
  EXPECT_EQ(charts.input.components, 4);
  EXPECT_EQ(charts.input.faces, mesh.face_count());
}

TEST(Charts, EveryRealMeshBecomesDisks) {
  if (test_data().empty()) GTEST_SKIP() << "there is no folder of real meshes here";
  for (const char* folder : {"paper", "disk", "closed"}) {
    for (const auto& file : std::filesystem::directory_iterator(test_data() / folder)) {
      if (file.path().extension() != ".obj") continue;
      const Surface surface = surface_of(read_obj(file.path()));
      const auto finite = [](const Vec3& p) { return p.allFinite(); };
      if (!std::all_of(surface.mesh.positions.begin(), surface.mesh.positions.end(), finite))
        continue;
      for (SeamMode seams : {SeamMode::automatic, SeamMode::keep, SeamMode::none})
        expect_valid(surface, make_charts(surface, seams), file.path().filename());
    }
  }
}

TEST(Charts, TellTwinsByPositionOfAllFacesWhateverIsSetAside) {
  TriMesh repeated = shapes::grid(4, 3);
  repeated.faces.push_back(repeated.faces[5]);
  TriMesh flat = shapes::grid(4, 3);
  flat.positions.push_back((flat.positions[0] + flat.positions[1]) / 2);
  flat.faces.push_back({1, 0, flat.vertex_count() - 1});
  const TriMesh whole = shapes::random_disk(6, 2);
  const TriMesh crates =
      merged(std::array{cube(), moved(cube(), Vec3(1, 0, 0)), moved(cube(), Vec3(0, 1, 0)),
                        moved(cube(), Vec3(1, 1, 0))});
  for (const TriMesh& mesh : {repeated, flat, whole, shapes::soup(whole), crates})
    for (const SeamMode mode : {SeamMode::automatic, SeamMode::keep, SeamMode::none}) {
      const Charts charts = components_of(shapes::surface_of(mesh), {mode});
      EXPECT_EQ(charts.by_position->twin, measure::halfedges_by_position(mesh).twin);
    }
}

}  // namespace
}  // namespace unwrapd::charts
