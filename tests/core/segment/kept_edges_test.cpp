// Edges that are kept, through the front door. Whether an edge is a seam is told here from the UVs
// of the corners on its two sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "core/segment/coarsen.hpp"
#include "core/segment/large_charts.hpp"
#include "core/unwrap.hpp"
#include "tests/core/segment/cut_up.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;
using Edge = std::array<Index, 2>;

/// The edges whose sides have different UVs, lower vertex first. The mesh has no copies.
std::set<Edge> seams_of_map(const TriMesh& mesh, const UnwrappedSurface& map) {
  std::map<Edge, std::vector<std::array<Vec2, 2>>> sides;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const Index a = mesh.faces[t][i], b = mesh.faces[t][j];
      const Vec2 u = map.uv[std::size_t(map.faces[t][i])], v = map.uv[std::size_t(map.faces[t][j])];
      sides[{std::min(a, b), std::max(a, b)}].push_back(a < b ? std::array{u, v}
                                                              : std::array{v, u});
    }
  std::set<Edge> seams;
  for (const auto& [edge, own] : sides)
    if (own.size() == 2 && own[0] != own[1]) seams.insert(edge);
  return seams;
}

std::vector<SeamPath> paths_of(const std::set<Edge>& edges) {
  std::vector<SeamPath> paths;
  for (const Edge& edge : edges) paths.push_back({0, {edge[0], edge[1]}});
  return paths;
}

Unwrapped unwrapped_of(const TriMesh& mesh, const UnwrapOptions& options) {
  const Surface surface = surface_of(mesh);
  SerialExecutor serial;
  return unwrap(std::span(&surface, 1), options, {}, serial);
}

std::vector<Edge> kept_but_cut(const TriMesh& mesh, const Unwrapped& unwrapped,
                               const std::set<Edge>& kept) {
  const std::set<Edge> seams = seams_of_map(mesh, unwrapped.surfaces[0]);
  std::vector<Edge> both;
  std::ranges::set_intersection(seams, kept, std::back_inserter(both));
  return both;
}

bool says_cut(const Unwrapped& unwrapped) {
  return std::ranges::count(unwrapped.report.notes, NoteCode::kept_edges_cut, &Note::code) > 0;
}

/// What an artist does: the seams that are seen from one side are not to be there.
std::set<Edge> in_view(const TriMesh& mesh, const std::set<Edge>& seams) {
  std::set<Edge> seen;
  for (const Edge& edge : seams)
    if (mesh.positions[std::size_t(edge[0])].x() + mesh.positions[std::size_t(edge[1])].x() > 0)
      seen.insert(edge);
  return seen;
}

TEST(KeptEdges, AreNoSeamsWhereSeamsWere) {
  const std::vector<UnwrapOptions> all = {
      {},
      {.max_distortion = 2.01},
      {.max_charts = 1},
      {.guarantee = Guarantee::bijective, .effort = Effort::fast},
      {.symmetry = Symmetry::automatic},
      {.boundary = BoundaryShape::circle}};
  for (const TriMesh& mesh : {sphere(2), torus(16, 8), pierced_bar(2)})
    for (const UnwrapOptions& options : all) {
      const Unwrapped before = unwrapped_of(mesh, options);
      const std::set<Edge> kept = in_view(mesh, seams_of_map(mesh, before.surfaces[0]));
      ASSERT_GT(kept.size(), 1U);
      UnwrapOptions keeping = options;
      keeping.keep_edges = paths_of(kept);
      const Unwrapped after = unwrapped_of(mesh, keeping);
      const std::size_t cut = kept_but_cut(mesh, after, kept).size();
      const bool may_split = options.symmetry != Symmetry::off;  // charts that overlap themselves
      EXPECT_LE(cut, may_split ? 1U : 0U) << "of " << kept.size() << " on " << mesh.faces.size()
                                          << " faces, by options " << &options - all.data();
      EXPECT_EQ(says_cut(after), cut > 0);
      EXPECT_EQ(after.report.distortion.flipped, 0);
    }
}

/// A ring may be crossed, but not followed.
TEST(KeptEdges, AroundATubeAreCrossedOnly) {
  const TriMesh tube = cylinder(24, 8);
  std::set<Edge> ring;
  for (Index k = 0; k < tube.vertex_count(); ++k)
    for (const Triangle& face : tube.faces)
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = face[i], b = face[(i + 1) % 3];
        if (a < b && tube.positions[std::size_t(a)].z() == tube.positions[std::size_t(b)].z())
          ring.insert({a, b});
      }
  const Unwrapped unwrapped =
      unwrapped_of(tube, {.keep_edges = paths_of(ring), .max_distortion = 2.02});
  EXPECT_TRUE(kept_but_cut(tube, unwrapped, ring).empty());
  EXPECT_LE(unwrapped.report.distortion.area, 2.02 + 1e-6);
}

TEST(KeptEdges, ThatLeaveNoWayToOpenASurfaceAreCounted) {
  const TriMesh ball = sphere(1);
  std::set<Edge> all;
  for (const Triangle& face : ball.faces)
    for (std::size_t i = 0; i < 3; ++i)
      all.insert({std::min(face[i], face[(i + 1) % 3]), std::max(face[i], face[(i + 1) % 3])});
  const Unwrapped unwrapped = unwrapped_of(ball, {.keep_edges = paths_of(all)});
  const std::size_t cut = kept_but_cut(ball, unwrapped, all).size();
  ASSERT_GT(cut, 0U);
  const auto note =
      std::ranges::find(unwrapped.report.notes, NoteCode::kept_edges_cut, &Note::code);
  ASSERT_NE(note, unwrapped.report.notes.end());
  EXPECT_TRUE(note->text.starts_with(std::to_string(cut) + " of " + std::to_string(all.size())))
      << note->text;
}

/// Through the coarse mesh: an edge of the large surface is kept, whatever cluster it lies in.
TEST(KeptEdges, OfALargeSurfaceAreKeptOnItsCoarseMesh) {
  const TriMesh ring = torus(80, 40);
  const Surface surface = surface_of(ring);
  SerialExecutor serial;
  const auto seams_with = [&](std::span<const SeamPath> kept) {
    const charts::Charts charts = charts::components_of(surface, {.kept = kept});
    const LargeCharts large = large_charts(charts.charts.front(), {}, {.faces = 600}, serial);
    std::set<Edge> seams;
    for (const charts::Chart& chart : large.charts)
      for (const BoundaryLoop& loop : chart.loops)
        for (const Index h : loop) {
          const Triangle& face = ring.faces[std::size_t(chart.face_source[std::size_t(h / 3)])];
          const Index a = face[std::size_t(h % 3)], b = face[std::size_t((h + 1) % 3)];
          seams.insert({std::min(a, b), std::max(a, b)});
        }
    return seams;
  };
  const std::set<Edge> kept = in_view(ring, seams_with({}));
  ASSERT_GT(kept.size(), 20U);
  const std::set<Edge> after = seams_with(paths_of(kept));
  std::vector<Edge> cut;
  std::ranges::set_intersection(after, kept, std::back_inserter(cut));
  EXPECT_TRUE(cut.empty()) << cut.size() << " of " << kept.size();
}

/// Every edge between two clusters, by going through all of them.
TEST(KeptEdges, BetweenClustersAreKeptOnTheCoarseMesh) {
  const Surface surface = surface_of(torus(40, 20));
  std::vector<SeamPath> around{{0, {}}};
  for (Index k = 0; k < 18; ++k) around[0].vertices.push_back(k);
  const charts::Charts charts = charts::components_of(surface, {.kept = around});
  const charts::Chart& component = charts.charts.front();
  Coarse coarse = coarsen(component.mesh, component.halfedges, 200, {});
  coarse.avoid = component.avoid;
  const std::vector<double> avoid = coarse_avoid(coarse, component.mesh, component.halfedges);
  const auto ends_at = [](const TriMesh& mesh, std::size_t h) {
    const Triangle& face = mesh.faces[h / 3];
    return Edge{face[h % 3], face[(h + 1) % 3]};
  };
  std::set<Edge> kept, found;
  for (std::size_t h = 0; h < component.avoid.size(); ++h) {
    const auto [a, b] = ends_at(component.mesh, h);
    const Index c = coarse.cluster[std::size_t(a)], d = coarse.cluster[std::size_t(b)];
    if (component.avoid[h] > 1 && c != d) kept.insert({c, d});
  }
  for (std::size_t h = 0; h < avoid.size(); ++h) {
    EXPECT_TRUE(avoid[h] == 0 || avoid[h] > 1);
    if (avoid[h] > 1) found.insert(ends_at(coarse.mesh, h));
  }
  EXPECT_GT(kept.size(), 4U);
  EXPECT_EQ(found, kept);
}

/// Three squares at one edge: two of them can lie side by side, the third is cut off.
TEST(KeptEdges, OfThreeFacesAreCountedWhereTheyAreCut) {
  const TriMesh fan{
      {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 0}, {-1, 0, 1}, {0, 1, 0}, {0, 1, 1}},
      {{0, 2, 3}, {0, 3, 1}, {1, 5, 4}, {1, 4, 0}, {0, 6, 7}, {0, 7, 1}}};
  const Unwrapped unwrapped = unwrapped_of(fan, {.keep_edges = {{0, {0, 1}}, {0, {0, 3}}}});
  ASSERT_TRUE(says_cut(unwrapped));
  const auto note =
      std::ranges::find(unwrapped.report.notes, NoteCode::kept_edges_cut, &Note::code);
  EXPECT_EQ(note->text.substr(0, 7), "1 of 2 ");
}

TEST(KeptEdges, AreTheSameForAnyThreads) {
  const Surface surface = surface_of(sphere(2));
  const UnwrapOptions options{
      .keep_edges = paths_of(in_view(
          surface.mesh, seams_of_map(surface.mesh, unwrapped_of(surface.mesh, {}).surfaces[0])))};
  SerialExecutor serial;
  TwoThreads two;
  const Unwrapped one = unwrap(std::span(&surface, 1), options, {}, serial);
  const Unwrapped other = unwrap(std::span(&surface, 1), options, {}, two);
  EXPECT_EQ(one.surfaces[0].uv, other.surfaces[0].uv);
}

TEST(KeptEdges, AreRefusedWhereTheyAreNoEdgesOrSeams) {
  TriMesh mesh = grid(2, 2);  // vertices 0 .. 8, row by row
  const auto where = [&](const UnwrapOptions& options) -> std::string {
    try {
      unwrapped_of(mesh, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_option);
      return error.where();
    }
    return "none";
  };
  EXPECT_EQ(where({.keep_edges = {{0, {3, 4}}}}), "none");
  EXPECT_EQ(where({.keep_edges = {{0, {3, 4}}, {0, {0, 8}}}}), "/keep_edges/1");
  EXPECT_EQ(where({.keep_edges = {{0, {3, 99}}}}), "/keep_edges/0");
  EXPECT_EQ(where({.keep_edges = {{0, {3}}}}), "/keep_edges/0/vertices");
  EXPECT_EQ(where({.keep_edges = {{0, {3, 4}}, {1, {3, 4}}}}), "/keep_edges/1/mesh");
  EXPECT_EQ(where({.seam_edges = {{7, {3, 4}}}}), "/seam_edges/0/mesh");
  EXPECT_EQ(where({.seam_edges = {{0, {3, 4, 5}}}, .keep_edges = {{0, {0, 1}}, {0, {5, 4}}}}),
            "/keep_edges/1");
  mesh.positions.push_back(mesh.positions[4]);  // a copy, by which one face knows vertex 4
  for (Index& v : mesh.faces.front())
    if (v == 4) v = 9;
  const UnwrapOptions by_copy{.seam_edges = {{0, {3, 4}}}, .keep_edges = {{0, {3, 9}}}};
  EXPECT_EQ(where(by_copy), "/keep_edges/0");
}

}  // namespace
}  // namespace unwrapd::segment
