#include "core/atlas/coarsen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/atlas/carry.hpp"
#include "core/atlas/region_charts.hpp"
#include "core/error.hpp"
#include "core/measure/orientation.hpp"
#include "core/mesh/topology.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

/// Every vertex moved along x, y and z by up to `most`, by a hash of its number.
TriMesh noisy(TriMesh mesh, double most) {
  std::uint32_t state = 1;
  for (Vec3& p : mesh.positions)
    for (int i = 0; i < 3; ++i) {
      state = state * 1664525U + 1013904223U;
      p[i] += most * (state / 2147483648.0 - 1);
    }
  return mesh;
}

std::vector<NamedMesh> surfaces() {
  return {{"sphere", sphere(4)},
          {"noisy torus", noisy(torus(48, 24), 0.02)},
          {"bar with three handles", subdivided(subdivided(pierced_bar(3)))},
          {"ring", annulus(60, 12)},
          {"noisy disk", noisy(grid(40, 40), 0.01)},
          {"punctured sphere", sphere_cap(48, 24, 3.1)}};
}

Component component_of(std::span<const Triangle> faces, const Halfedges& halfedges) {
  const Topology shape = topology(faces, halfedges);
  EXPECT_EQ(shape.components.size(), 1U);
  return shape.components.front();
}

TEST(Coarsen, KeepsGenusAndBoundariesOfASurfaceAndMakesItSmall) {
  for (const auto& [name, mesh] : surfaces()) {
    const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
    const Coarse coarse = coarsen(mesh, halfedges, 200, {});
    EXPECT_LE(coarse.mesh.face_count(), 200) << name;
    EXPECT_EQ(build_halfedges(coarse.mesh.faces, coarse.mesh.vertex_count()).twin,
              coarse.halfedges.twin)
        << name;
    const Component before = component_of(mesh.faces, halfedges);
    const Component after = component_of(coarse.mesh.faces, coarse.halfedges);
    EXPECT_EQ(after.genus, before.genus) << name;
    EXPECT_EQ(after.boundaries, before.boundaries) << name;
  }
}

TEST(Coarsen, PutsEachVertexInTheMiddleOfItsClusterAndKeepsOneFaceForThree) {
  const TriMesh mesh = torus(48, 24);
  const Coarse coarse = coarsen(mesh, build_halfedges(mesh.faces, mesh.vertex_count()), 300, {});
  std::vector<int> members(coarse.mesh.positions.size(), 0);
  std::vector<Vec3> least(members.size(), Vec3::Constant(9)), most(members.size(), -least[0]);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto c = std::size_t(coarse.cluster[v]);
    ++members[c];
    least[c] = least[c].cwiseMin(mesh.positions[v]);
    most[c] = most[c].cwiseMax(mesh.positions[v]);
  }
  for (std::size_t c = 0; c < members.size(); ++c) {
    EXPECT_GE(members[c], 1);
    EXPECT_LE(members[c], 40);  // 8 on average
    EXPECT_TRUE((coarse.mesh.positions[c] - least[c]).minCoeff() >= -1e-12);
    EXPECT_TRUE((most[c] - coarse.mesh.positions[c]).minCoeff() >= -1e-12);
  }
  for (std::size_t t = 0; t < coarse.face.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(coarse.cluster[std::size_t(mesh.faces[std::size_t(coarse.face[t])][i])],
                coarse.mesh.faces[t][i]);
}

/// Slabs of the small surface along x, and a slit where y changes its sign.
std::vector<char> slabs(const Coarse& coarse, double width) {
  const auto slab = [&](Index t) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : coarse.mesh.faces[std::size_t(t)])
      sum += coarse.mesh.positions[std::size_t(v)] / 3;
    return std::pair(std::floor(sum.x() / width), sum.z() > 0 && sum.y() > 0);
  };
  std::vector<char> seam;
  for (Index h = 0; h < Index(coarse.halfedges.twin.size()); ++h) {
    const Index twin = coarse.halfedges.twin[std::size_t(h)];
    seam.push_back(twin != kNoTwin && slab(face_of(h)) != slab(face_of(twin)) ? 1 : 0);
  }
  return seam;
}

using Kind = std::tuple<Index, Index>;

/// Genus and boundaries of the parts that a cut leaves, named by their lowest core.
std::vector<Kind> kinds(const Halfedges& cut, std::span<const Index> cores) {
  const Topology shape = topology(corner_vertices(cut).faces, cut);
  std::vector<Kind> kinds;
  std::vector<char> seen(shape.components.size(), 0);
  for (const Index t : cores) {
    const auto c = std::size_t(shape.component_of[std::size_t(t)]);
    if (std::exchange(seen[c], 1) == 0)
      kinds.emplace_back(shape.components[c].genus, shape.components[c].boundaries);
  }
  EXPECT_EQ(kinds.size(), shape.components.size());  // no part without a core
  return kinds;
}

TEST(Carry, CutsTheLargeSurfaceIntoPartsOfTheSameGenusAndBoundaries) {
  for (const auto& [name, mesh] : surfaces())
    for (const double width : {0.3, 0.7, 50.0}) {
      const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
      const Coarse coarse = coarsen(mesh, halfedges, 300, {});
      const std::vector<char> seam = slabs(coarse, width);
      Halfedges cut = coarse.halfedges;
      std::vector<Index> all;
      for (std::size_t h = 0; h < seam.size(); ++h)
        if (seam[h] != 0) cut.twin[h] = kNoTwin;
      for (Index t = 0; t < coarse.mesh.face_count(); ++t) all.push_back(t);
      const Carried carried = carry(mesh, halfedges, coarse, seam, {});
      EXPECT_EQ(kinds(carried.cut, coarse.face), kinds(cut, all)) << name << ' ' << width;
      EXPECT_GE(std::ranges::min(carried.near), 0) << name;
    }
}

TEST(Carry, CutsNothingWhereThereIsNoSeam) {
  const TriMesh mesh = sphere(4);
  const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
  const Coarse coarse = coarsen(mesh, halfedges, 300, {});
  const std::vector<char> none(coarse.halfedges.twin.size(), 0);
  EXPECT_EQ(carry(mesh, halfedges, coarse, none, {}).cut.twin, halfedges.twin);
}

TEST(Coarsen, StopsWhenTold) {
  const TriMesh mesh = sphere(4);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(
      coarsen(mesh, build_halfedges(mesh.faces, mesh.vertex_count()), 200, source.get_token()),
      Error);
}

std::vector<Chart> charts_through_a_small_surface(const Chart& component, Executor& executor) {
  const Coarse coarse = coarsen(component.mesh, component.halfedges, 2000, {});
  const Sheet sheet = make_sheet(coarse.mesh, coarse.halfedges);
  return region_charts(component, coarse, segment(sheet, {}, executor), {});
}

TEST(RegionCharts, TakeANoisySurfaceApartIntoAFewDisksTheSameOnTwoThreads) {
  const TriMesh mesh = noisy(torus(150, 75, 1, 0.4), 0.004);  // edges of 0.04
  const Charts whole = components_of(surface_of(mesh), {});
  SerialExecutor one;
  TwoThreads two;
  const std::vector<Chart> charts = charts_through_a_small_surface(whole.charts.front(), one);
  const std::vector<Chart> again = charts_through_a_small_surface(whole.charts.front(), two);
  EXPECT_LE(charts.size(), 4U);
  ASSERT_EQ(again.size(), charts.size());
  std::size_t faces = 0;
  for (std::size_t k = 0; k < charts.size(); ++k) {
    EXPECT_TRUE(is_disk(charts[k]));
    EXPECT_LE(flipped_faces(charts[k].mesh.faces, charts[k].start).size(),
              charts[k].mesh.faces.size() / 100);
    EXPECT_EQ(again[k].start, charts[k].start);
    faces += charts[k].mesh.faces.size();
  }
  EXPECT_EQ(faces, mesh.faces.size());
}

}  // namespace
}  // namespace unwrapd
