#include "core/segment/coarsen.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "core/base/error.hpp"
#include "core/charts/charts.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/topology.hpp"
#include "core/segment/transfer_seams.hpp"
#include "tests/core/hard_shapes.hpp"

namespace unwrapd::segment {
namespace {

using namespace shapes;

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

struct Contracted {
  Component before, after;
};

/// What contracting as far as it goes leaves of a surface.
Contracted contracted(const charts::Chart& c) {
  const Coarse coarse = coarsen(c.mesh, c.halfedges, 1, {});
  return {component_of(c.mesh.faces, c.halfedges),
          component_of(corner_vertices(coarse.halfedges).faces, coarse.halfedges)};
}

charts::Chart component(const TriMesh& mesh) {
  return std::move(charts::components_of(surface_of(mesh), {}).charts.front());
}

/// Where an edge's ends have a third neighbour in common, where an edge runs from rim to rim, and
/// where there are two edges between the same ends.
TEST(Coarsen, StopsBeforeItPinches) {
  TriMesh pillow = grid(1, 1);
  for (std::size_t t : {0U, 1U}) {
    const Triangle face = pillow.faces[t];
    pillow.faces.push_back({face[0], face[2], face[1]});
  }
  const std::vector<NamedMesh> thin{{"thin ring", torus(80, 3, 1, 0.05)},
                                    {"sphere", sphere(2)},
                                    {"ribbon", annulus(200, 2, 0.96, 1)},
                                    {"strip", grid(80, 2, 1, 0.02)},
                                    {"pillow", pillow}};
  for (const auto& [name, mesh] : thin) {
    const Contracted kept = contracted(component(mesh));
    EXPECT_EQ(kept.after.genus, kept.before.genus) << name;
    EXPECT_EQ(kept.after.boundaries, kept.before.boundaries) << name;
  }
}

/// All of them look up, whatever bends the border.
TEST(Coarsen, TurnsNoFaceOver) {
  TriMesh comb = grid(60, 40);
  std::erase_if(comb.faces, [&](const Triangle& face) {
    const Vec3& p = comb.positions[std::size_t(face[0])];
    return p.y() > 0.3 && std::fmod(p.x() * 15, 2) > 1;
  });
  for (Vec3& p : comb.positions) p += 0.006 * Vec3(std::sin(900 * p.y()), std::sin(700 * p.x()), 0);
  const charts::Chart chart = component(comb);
  const Coarse coarse = coarsen(chart.mesh, chart.halfedges, 60, {});
  const Vec3 up = Vec3::UnitZ();
  for (const Triangle& face : coarse.mesh.faces) {
    const auto at = [&](std::size_t i) { return coarse.mesh.positions[std::size_t(face[i])]; };
    EXPECT_GT((at(1) - at(0)).cross(at(2) - at(0)).dot(up), 0);
  }
}

/// Whatever the triangles were: near the pole of a cap they are a hundred times smaller.
TEST(Coarsen, MakesClustersOfOneArea) {
  const TriMesh mesh = sphere_cap(96, 60, 2.5);
  const Coarse coarse = coarsen(mesh, build_halfedges(mesh.faces, mesh.vertex_count()), 600, {});
  std::vector<double> area(coarse.mesh.positions.size(), 0);
  double total = 0;
  for (const Triangle& face : mesh.faces) {
    const auto at = [&](std::size_t i) { return mesh.positions[std::size_t(face[i])]; };
    const double own = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    total += own;
    for (const Index v : face) area[std::size_t(coarse.cluster[std::size_t(v)])] += own / 3;
  }
  const double mean = total / double(area.size());
  double spread = 0;
  for (const double own : area) spread += (own / mean - 1) * (own / mean - 1);
  EXPECT_LT(std::sqrt(spread / double(area.size())), 0.3);
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

TEST(TransferSeams, CutsTheLargeSurfaceIntoPartsOfTheSameGenusAndBoundaries) {
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
      const TransferredSeams transferred = transfer_seams(mesh, halfedges, coarse, seam, {});
      EXPECT_EQ(kinds(transferred.cut, coarse.face), kinds(cut, all)) << name << ' ' << width;
      EXPECT_GE(std::ranges::min(transferred.near), 0) << name;
    }
}

double seam_length(const TriMesh& mesh, const Halfedges& cut, const Halfedges& uncut) {
  double length = 0;
  for (Index h = 0; h < Index(cut.twin.size()); ++h)
    if (cut.twin[std::size_t(h)] != uncut.twin[std::size_t(h)])
      length += (mesh.positions[std::size_t(end_of(mesh.faces, h))] -
                 mesh.positions[std::size_t(start_of(mesh.faces, h))])
                    .norm();
  return length / 2;
}

TEST(TransferSeams, TakesTheShortestWay) {
  for (const auto& [name, mesh] : surfaces()) {
    const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
    const Coarse coarse = coarsen(mesh, halfedges, 300, {});
    const std::vector<char> seam = slabs(coarse, 0.7);
    Halfedges cut = coarse.halfedges;
    for (std::size_t h = 0; h < seam.size(); ++h)
      if (seam[h] != 0) cut.twin[h] = kNoTwin;
    const TransferredSeams transferred = transfer_seams(mesh, halfedges, coarse, seam, {});
    const double large = seam_length(mesh, transferred.cut, halfedges);
    const double small = seam_length(coarse.mesh, cut, coarse.halfedges);
    EXPECT_LT(large, 1.15 * small) << name;
  }
}

/// Any edges are seams: rings around a vertex, tips, forks.
std::vector<char> seams_by_lot(const Coarse& coarse, std::mt19937& rng) {
  std::vector<char> seam(coarse.halfedges.twin.size(), 0);
  const auto share = 1 + rng() % 60;
  for (Index h = 0; h < Index(seam.size()); ++h) {
    const Index twin = coarse.halfedges.twin[std::size_t(h)];
    if (twin > h && rng() % 64 < share) seam[std::size_t(h)] = seam[std::size_t(twin)] = 1;
  }
  return seam;
}

/// A row of seams may enclose faces between two that the small surface has: they are no part.
TEST(TransferSeams, LeavesNoPartWithoutAFaceOfTheSmallSurface) {
  std::mt19937 rng(1);
  for (const auto& [name, mesh] : surfaces()) {
    const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
    for (const int target : {20, 60, 300}) {
      const Coarse coarse = coarsen(mesh, halfedges, target, {});
      for (int k = 0; k < 80; ++k) {
        const TransferredSeams transferred =
            transfer_seams(mesh, halfedges, coarse, seams_by_lot(coarse, rng), {});
        EXPECT_GE(std::ranges::min(transferred.near), 0) << name << ' ' << target << ' ' << k;
      }
    }
  }
}

TEST(TransferSeams, CutsNothingWhereThereIsNoSeam) {
  const TriMesh mesh = sphere(4);
  const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
  const Coarse coarse = coarsen(mesh, halfedges, 300, {});
  const std::vector<char> none(coarse.halfedges.twin.size(), 0);
  EXPECT_EQ(transfer_seams(mesh, halfedges, coarse, none, {}).cut.twin, halfedges.twin);
}

TEST(Coarsen, StopsWhenTold) {
  const TriMesh mesh = sphere(4);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(
      coarsen(mesh, build_halfedges(mesh.faces, mesh.vertex_count()), 200, source.get_token()),
      Error);
}

}  // namespace
}  // namespace unwrapd::segment
