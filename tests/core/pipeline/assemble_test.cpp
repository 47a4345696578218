#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/measure/seam_length.hpp"
#include "core/pack/pack.hpp"
#include "core/pipeline/assemble.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::pipeline {
namespace {

using namespace shapes;

/// A UV of its own for every chart vertex, so that mistakes show.
std::vector<UvMap> labels(const charts::Charts& charts) {
  std::vector<UvMap> all;
  for (std::size_t k = 0; k < charts.charts.size(); ++k) {
    UvMap uv;
    for (Index v = 0; v < charts.charts[k].mesh.vertex_count(); ++v)
      uv.emplace_back(1.0 / (2.0 + double(k)), 1.0 / (1.0 + v));
    all.push_back(uv);
  }
  return all;
}

struct Assembled {
  Surface surface;
  charts::Charts charts;
  std::vector<UvMap> uv;
  UnwrappedSurface out;
};

Assembled assembled(const TriMesh& mesh, SeamMode seams = SeamMode::none) {
  Assembled a{surface_of(mesh), {}, {}, {}};
  a.charts = charts::make_charts(a.surface, seams);
  a.uv = labels(a.charts);
  a.out = assemble(a.surface, a.charts, a.uv);
  return a;
}

void expect_consistent(const Assembled& a) {
  const Index n = a.surface.mesh.vertex_count();
  ASSERT_GE(Index(a.out.source.size()), n);
  ASSERT_EQ(a.out.source.size(), a.out.uv.size());
  for (Index v = 0; v < n; ++v) EXPECT_EQ(a.out.source[v], v);
  ASSERT_EQ(a.out.faces.size(), a.surface.mesh.faces.size());
  for (std::size_t t = 0; t < a.out.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(a.out.source[a.out.faces[t][i]], a.surface.mesh.faces[t][i]);
  std::set<std::array<double, 3>> distinct;  // no copy without need
  for (std::size_t v = 0; v < a.out.uv.size(); ++v)
    EXPECT_TRUE(
        distinct.insert({double(a.out.source[v]), a.out.uv[v].x(), a.out.uv[v].y()}).second);
  for (std::size_t k = 0; k < a.charts.charts.size(); ++k) {
    const charts::Chart& chart = a.charts.charts[k];
    for (std::size_t t = 0; t < chart.face_source.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(a.out.uv[a.out.faces[chart.face_source[t]][i]], a.uv[k][chart.mesh.faces[t][i]]);
  }
}

TEST(Assemble, GivesEveryCornerTheUvOfItsChart) {
  for (const TriMesh& mesh : {grid(3, 2), torus(7, 5), sphere(2), soup(cube(1)), bow_tie(),
                              pierced_bar(2), shuffled(torus(9, 5), 1)})
    for (SeamMode seams : {SeamMode::automatic, SeamMode::keep, SeamMode::none})
      expect_consistent(assembled(mesh, seams));
}

TEST(Assemble, AddsNoVertexToADisk) {
  const Assembled a = assembled(random_disk(5, 2));
  EXPECT_EQ(a.out.source.size(), a.surface.mesh.positions.size());
  EXPECT_EQ(a.out.faces, a.surface.mesh.faces);
}

TEST(Assemble, TheFirstCornerKeepsTheNumberAndCopiesFollowInFaceOrder) {
  const Assembled a = assembled(bow_tie());
  EXPECT_EQ(a.out.faces, (std::vector<Triangle>{{0, 1, 2}, {5, 3, 4}}));
  EXPECT_EQ(a.out.source.back(), 0);
}

TEST(Assemble, ADuplicateLooksLikeTheFaceThatItRepeats) {
  TriMesh mesh = grid(2, 2);
  const auto [x, y, z] = mesh.faces[3];
  const Index n = mesh.vertex_count();
  for (Index v : {y, z, x}) mesh.positions.push_back(mesh.positions[v]);
  mesh.faces.push_back({n, n + 1, n + 2});  // turned, over vertices of its own
  const Assembled a = assembled(mesh);
  EXPECT_EQ(a.charts.set_aside, (std::vector<Index>{8}));
  const Triangle& original = a.out.faces[3];
  const Triangle& copy = a.out.faces[8];
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.out.uv[copy[i]], a.out.uv[original[(i + 1) % 3]]);
}

/// How many of the distinct UVs of a face that is set aside; they must be ends of one charted edge.
std::size_t points_of_degenerate(const Assembled& a, Index t) {
  std::vector<Vec2> points;
  for (const Index v : a.out.faces[t])
    if (std::find(points.begin(), points.end(), a.out.uv[v]) == points.end())
      points.push_back(a.out.uv[v]);
  if (points.size() != 2) return points.size();
  bool is_edge = false;
  for (std::size_t k = 0; k < a.uv.size(); ++k)
    for (const Triangle& face : a.charts.charts[k].mesh.faces)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec2 &p = a.uv[k][face[i]], &q = a.uv[k][face[(i + 1) % 3]];
        is_edge |= (p == points[0] && q == points[1]) || (q == points[0] && p == points[1]);
      }
  EXPECT_TRUE(is_edge) << "face " << t << " spans more than an edge of a chart";
  return 2;
}

TEST(Assemble, ADegenerateFaceLiesOnAnEdgeOrAPointOfAChart) {
  TriMesh mesh = merged(std::array{grid(1, 1), moved(grid(1, 1), {3, 0, 0})});
  mesh.faces.push_back({0, 1, 5});  // on a line, across both squares
  mesh.positions.push_back(mesh.positions[2]);
  mesh.faces.push_back({2, 8, 3});  // one corner has no chart of its own, but its position has
  mesh.positions.emplace_back(0, 0, 7);
  mesh.positions.emplace_back(0, 0, 9);
  mesh.faces.push_back({9, 10, 0});  // of three points one is known
  const Assembled a = assembled(mesh, SeamMode::keep);
  ASSERT_EQ(a.charts.set_aside, (std::vector<Index>{4, 5, 6}));
  EXPECT_EQ(points_of_degenerate(a, 4), 2U);
  EXPECT_EQ(a.out.uv[a.out.faces[4][2]], a.out.uv[a.out.faces[4][1]]);  // 1 is nearer to 5 than 0
  EXPECT_EQ(points_of_degenerate(a, 5), 2U);
  EXPECT_EQ(a.out.uv[a.out.faces[5][0]], a.out.uv[a.out.faces[5][1]]);
  EXPECT_EQ(points_of_degenerate(a, 6), 1U);
}

TEST(Assemble, DegenerateFacesCoverNothingWhereverTheyAre) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 rng(seed);
    TriMesh mesh = std::array{torus(8, 4), cube(4), bow_tie(), soup(cube(2))}[seed % 4];
    const std::size_t sound = mesh.faces.size();
    for (int k = 0; k < 30; ++k) {  // points on one line, often of far ends of the surface
      const Index n = mesh.vertex_count();
      const auto any = [&] { return Index(rng() % std::uint32_t(n)); };
      const Index a = any(), b = any();
      mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) / 2);
      mesh.faces.push_back(rng() % 3 == 0 ? Triangle{a, b, a} : Triangle{a, n, b});
    }
    const Assembled a = assembled(mesh, seed % 3 == 0 ? SeamMode::keep : SeamMode::automatic);
    SCOPED_TRACE(seed);
    EXPECT_GE(a.charts.set_aside.size(), mesh.faces.size() - sound);
    for (std::size_t k = 0; k < a.charts.set_aside.size(); ++k)
      if (a.charts.repeats[k] < 0) {
        EXPECT_LE(points_of_degenerate(a, a.charts.set_aside[k]), 2U);
      }
    expect_consistent(a);
  }
}

TEST(Assemble, AFaceWithoutAreaMakesNoSeam) {
  // a square above, two triangles below, and between them a face that closes the gap at vertex 4
  const TriMesh mesh{
      {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}, {0, -2, 0}, {2, -2, 0}},
      {{0, 1, 2}, {0, 2, 3}, {0, 5, 4}, {4, 5, 6}, {4, 6, 1}, {0, 4, 1}}};
  const Assembled a = assembled(mesh);
  ASSERT_EQ(a.charts.set_aside, (std::vector<Index>{5}));
  ASSERT_EQ(a.charts.charts.size(), 2U);
  EXPECT_EQ(points_of_degenerate(a, 5), 2U);
  EXPECT_EQ(measure::seam_length(a.surface, a.out), 0);
}

TEST(Assemble, WithoutAnyChartEverythingIsAtTheOrigin) {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {7, 7, 7}}, {{0, 1, 2}}};
  const Assembled a = assembled(mesh);
  EXPECT_TRUE(a.charts.charts.empty());
  EXPECT_EQ(a.out.faces, mesh.faces);
  EXPECT_EQ(a.out.uv, UvMap(4, Vec2(0, 0)));
}

}  // namespace
}  // namespace unwrapd::pipeline
