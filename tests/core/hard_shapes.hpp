#pragma once
// Disks that are hard on a solver, and surfaces that come in broken.

#include <string>
#include <vector>

#include "tests/core/shapes.hpp"

namespace unwrapd::shapes {

struct NamedMesh {
  std::string name;
  TriMesh mesh;
};

/// A vertex with very many neighbours, as on the tip of a cone that was not remeshed.
inline TriMesh fan(Index blades, double height = 0.3) {
  TriMesh mesh{{Vec3(0, 0, height)}, {}};
  for (Index k = 0; k <= blades; ++k) {
    const double angle = 5.5 * k / blades;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.02 * (k % 3));
  }
  for (Index k = 0; k < blades; ++k) mesh.faces.push_back({0, k + 1, k + 2});
  return mesh;
}

/// A bumpy disk squeezed along x: every triangle is a sliver.
inline TriMesh slivers(Index n, unsigned seed, double width) {
  TriMesh mesh = random_disk(n, seed);
  for (Vec3& p : mesh.positions) p.x() *= width;
  return mesh;
}

/// A bumpy disk with one row of vertices drawn almost onto the next: needles among good triangles.
inline TriMesh needles(Index n, unsigned seed, double height) {
  TriMesh mesh = random_disk(n, seed);
  for (Index i = 0; i <= n; ++i) {
    const Vec3& above = mesh.positions[std::size_t((n / 2 + 1) * (n + 1) + i)];
    Vec3& own = mesh.positions[std::size_t(n / 2 * (n + 1) + i)];
    own = above + height * (own - above);
  }
  return mesh;
}

/// A bumpy disk with square holes: several boundaries.
inline TriMesh pierced_disk(Index n, unsigned seed) {
  TriMesh mesh = random_disk(n, seed), kept{mesh.positions, {}};
  for (Index t = 0; t < mesh.face_count(); ++t) {
    const Index i = t / 2 % n, j = t / 2 / n;
    if (i % 4 != 2 || j % 4 != 2) kept.faces.push_back(mesh.faces[std::size_t(t)]);
  }
  return kept;
}

/// A long strip that is rolled up: developable, and folded over itself from most directions.
inline TriMesh spiral(Index along, double turns = 3) {
  return mapped_grid(along, 2, Wrap::none, [&](double u, double v) {
    const double angle = kTurn * turns * u, radius = 0.3 + u;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.1 * v);
  });
}

inline std::vector<NamedMesh> hard_disks() {
  return {{"one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}},
          {"two triangles", grid(1, 1)},
          {"a fan without inner vertices", fan(5)},
          {"a fan of 300 blades", fan(300)},
          {"slivers of 1:1e3", slivers(8, 1, 1e-3)},
          {"slivers of 1:1e6", slivers(8, 2, 1e-6)},
          {"needles of 1e-5", needles(8, 3, 1e-5)},
          {"needles below the floor", needles(8, 4, 1e-9)},
          {"nine holes", pierced_disk(12, 5)},
          {"a spiral", spiral(200)},
          {"a deep cap", sphere_cap(24, 10, 2.6)}};
}

/// Not disks as they come in: faces without area, twice or turned over, edges with three faces.
inline std::vector<NamedMesh> broken_surfaces() {
  TriMesh degenerate = random_disk(5, 6);
  degenerate.faces.push_back({0, 1, 1});
  degenerate.faces.push_back({7, 7, 7});
  degenerate.positions.push_back((degenerate.positions[0] + degenerate.positions[1]) / 2);
  degenerate.faces.push_back({0, degenerate.vertex_count() - 1, 1});
  TriMesh doubled = random_disk(5, 7);
  doubled.faces.insert(doubled.faces.end(), doubled.faces.begin(), doubled.faces.begin() + 9);
  return {{"faces without area", degenerate},
          {"faces twice", doubled},
          {"three faces at an edge", three_faces_at_an_edge()},
          {"a bow tie", bow_tie()},
          {"a closed sphere", sphere(1)},
          {"a torus", torus(8, 5)}};
}

/// Every vertex moved along x, y and z by up to `most`, by a hash of its number.
inline TriMesh noisy(TriMesh mesh, double most) {
  std::uint32_t state = 1;
  for (Vec3& p : mesh.positions)
    for (int i = 0; i < 3; ++i) {
      state = state * 1664525U + 1013904223U;
      p[i] += most * (state / 2147483648.0 - 1);
    }
  return mesh;
}

}  // namespace unwrapd::shapes
