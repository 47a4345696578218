#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/atlas/pack.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

/// A UV of its own for every chart vertex, so that mistakes show.
std::vector<UvMap> labels(const Charts& charts) {
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
  Charts charts;
  std::vector<UvMap> uv;
  UnwrappedSurface out;
};

Assembled assembled(const TriMesh& mesh, SeamMode seams = SeamMode::none) {
  Assembled a{surface_of(mesh), {}, {}, {}};
  a.charts = make_charts(a.surface, seams);
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
    const Chart& chart = a.charts.charts[k];
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

TEST(Assemble, ADegenerateFaceStaysWithinOneChart) {
  TriMesh mesh = grid(1, 1);
  const TriMesh other = moved(grid(1, 1), {3, 0, 0});
  mesh = merged(std::array{mesh, other});
  mesh.faces.push_back({0, 1, 5});  // on a line, across both squares
  mesh.positions.push_back(mesh.positions[2]);
  mesh.faces.push_back({2, 8, 3});  // one corner has no chart of its own, but its position has
  const Assembled a = assembled(mesh, SeamMode::keep);
  ASSERT_EQ(a.charts.set_aside, (std::vector<Index>{4, 5}));
  const Triangle& flat = a.out.faces[4];
  EXPECT_EQ(a.out.uv[flat[0]], a.out.uv[flat[1]]);
  EXPECT_EQ(a.out.uv[flat[0]], a.out.uv[flat[2]]);
  const Triangle& collapsed = a.out.faces[5];
  EXPECT_EQ(a.out.uv[collapsed[0]], a.out.uv[collapsed[1]]);
}

TEST(Assemble, WithoutAnyChartEverythingIsAtTheOrigin) {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {7, 7, 7}}, {{0, 1, 2}}};
  const Assembled a = assembled(mesh);
  EXPECT_TRUE(a.charts.charts.empty());
  EXPECT_EQ(a.out.faces, mesh.faces);
  EXPECT_EQ(a.out.uv, UvMap(4, Vec2(0, 0)));
}

}  // namespace
}  // namespace unwrapd
