#pragma once
// Shapes with known answers, for the tests: topology, area, developability known by construction.
// Faces are counter-clockwise seen from outside (or from +z); around, along, rings count quads.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::shapes {

inline constexpr double kTurn = 2 * std::numbers::pi;

inline void add_quad(std::vector<Triangle>& faces, Index a, Index b, Index c, Index d) {
  faces.push_back({a, b, c});
  faces.push_back({a, c, d});
}

enum class Wrap { none, first, both };  ///< which directions of a grid are closed

/// A grid of columns x rows quads; point(u, v) with u, v in [0, 1] gives the positions.
template <class Point>
TriMesh mapped_grid(Index columns, Index rows, Wrap wrap, Point point) {
  const Index m = wrap == Wrap::none ? columns + 1 : columns;
  const Index n = wrap == Wrap::both ? rows : rows + 1;
  TriMesh mesh;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < m; ++i)
      mesh.positions.push_back(point(double(i) / columns, double(j) / rows));
  const auto id = [&](Index i, Index j) { return i % m + j % n * m; };
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i)
      add_quad(mesh.faces, id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
  return mesh;
}

/// A flat rectangle in the plane z = 0: a disk.
inline TriMesh grid(Index columns, Index rows, double width = 1, double height = 1) {
  return mapped_grid(columns, rows, Wrap::none,
                     [&](double u, double v) { return Vec3(width * u, height * v, 0); });
}

/// A flat ring: two boundaries, Euler characteristic 0.
inline TriMesh annulus(Index around, Index across, double inner = 0.5, double outer = 1) {
  return mapped_grid(around, across, Wrap::first, [&](double u, double v) {
    const double r = outer + (inner - outer) * v;
    return Vec3(r * std::cos(kTurn * u), r * std::sin(kTurn * u), 0);
  });
}

/// Open at both ends: two boundaries.
inline TriMesh cylinder(Index around, Index along, double radius = 1, double height = 2) {
  return mapped_grid(around, along, Wrap::first, [&](double u, double v) {
    return Vec3(radius * std::cos(kTurn * u), radius * std::sin(kTurn * u), height * v);
  });
}

/// A bent rectangle, developable: a disk.
inline TriMesh half_cylinder(Index around, Index along, double radius = 1, double height = 2) {
  return mapped_grid(around, along, Wrap::none, [&](double u, double v) {
    return Vec3(radius * std::cos(kTurn / 2 * u), radius * std::sin(kTurn / 2 * u), height * v);
  });
}

/// Closed, genus 1.
inline TriMesh torus(Index around, Index along, double radius = 1, double tube = 0.4) {
  return mapped_grid(around, along, Wrap::both, [&](double u, double v) {
    const double r = radius + tube * std::cos(kTurn * v);
    return Vec3(r * std::cos(kTurn * u), r * std::sin(kTurn * u), tube * std::sin(kTurn * v));
  });
}

/// Rings about a centre vertex (number 0); point(r, angle) with r in [0, 1], angle in [0, turn].
/// A whole turn closes the rings; less leaves them open. A disk either way.
template <class Point>
TriMesh polar_disk(Index around, Index rings, double turn, Point point) {
  const bool closed = turn == kTurn;
  const Index m = closed ? around : around + 1;
  TriMesh mesh;
  mesh.positions.push_back(point(0.0, 0.0));
  for (Index j = 1; j <= rings; ++j)
    for (Index k = 0; k < m; ++k)
      mesh.positions.push_back(point(double(j) / rings, turn * k / around));
  const auto id = [&](Index k, Index j) { return 1 + k % m + (j - 1) * m; };
  for (Index k = 0; k < around; ++k) mesh.faces.push_back({0, id(k, 1), id(k + 1, 1)});
  for (Index j = 1; j < rings; ++j)
    for (Index k = 0; k < around; ++k)
      add_quad(mesh.faces, id(k, j), id(k, j + 1), id(k + 1, j + 1), id(k + 1, j));
  return mesh;
}

/// The cap of the unit sphere about +z, down to `angle` radians from the pole, angle < pi.
inline TriMesh sphere_cap(Index around, Index rings, double angle = 1) {
  return polar_disk(around, rings, kTurn, [&](double r, double phi) {
    const double s = std::sin(angle * r);
    return Vec3(s * std::cos(phi), s * std::sin(phi), std::cos(angle * r));
  });
}

/// A cone of base radius 1 with its apex at (0, 0, height): a disk, developable but at the apex.
inline TriMesh cone(Index around, Index rings, double height = 1) {
  return polar_disk(around, rings, kTurn, [&](double r, double phi) {
    return Vec3(r * std::cos(phi), r * std::sin(phi), height * (1 - r));
  });
}

/// `turn` radians (less than kTurn) of such a cone: developable, apex included.
inline TriMesh cone_sector(Index around, Index rings, double height = 1, double turn = 5) {
  return polar_disk(around, rings, turn, [&](double r, double phi) {
    return Vec3(r * std::cos(phi), r * std::sin(phi), height * (1 - r));
  });
}

/// One half twist: one boundary, not orientable; around >= 3.
inline TriMesh mobius_strip(Index around, Index across = 2) {
  TriMesh mesh = mapped_grid(around, across, Wrap::none, [](double u, double v) {
    const double s = 0.4 * (2 * v - 1), half = kTurn / 2 * u;
    const double r = 1 + s * std::cos(half);
    return Vec3(r * std::cos(kTurn * u), r * std::sin(kTurn * u), s * std::sin(half));
  });
  for (Triangle& face : mesh.faces)  // the last column is the first one upside down
    for (Index& v : face)
      if (v % (around + 1) == around) v = (across - v / (around + 1)) * (around + 1);
  return mesh;
}

/// Each triangle into four; new vertices at the midpoints.
inline TriMesh subdivided(const TriMesh& mesh) {
  TriMesh finer{mesh.positions, {}};
  std::map<std::pair<Index, Index>, Index> middle;
  const auto mid = [&](Index a, Index b) {
    const auto [at, is_new] = middle.try_emplace(std::minmax(a, b), finer.vertex_count());
    if (is_new)
      finer.positions.push_back((mesh.positions[std::size_t(a)] + mesh.positions[std::size_t(b)]) /
                                2);
    return at->second;
  };
  for (const auto& [a, b, c] : mesh.faces) {
    const Index ab = mid(a, b), bc = mid(b, c), ca = mid(c, a);
    for (const Triangle& face : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      finer.faces.push_back(face);
  }
  return finer;
}

/// The surface of a set of unit cells (a cell is its least corner): quads, two triangles each.
inline TriMesh voxel_surface(const std::set<std::array<int, 3>>& cells) {
  TriMesh mesh;
  std::map<std::array<int, 3>, Index> vertex;
  const auto id = [&](const std::array<int, 3>& p) {
    const auto [at, is_new] = vertex.try_emplace(p, mesh.vertex_count());
    if (is_new) mesh.positions.emplace_back(p[0], p[1], p[2]);
    return at->second;
  };
  const auto add_side = [&](const std::array<int, 3>& cell, std::size_t axis, int step) {
    std::array<int, 3> next = cell;
    next[axis] += step;
    if (cells.contains(next)) return;
    std::array<std::array<int, 3>, 4> corner{cell, cell, cell, cell};
    const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
    for (auto& p : corner) p[axis] += step > 0;
    ++corner[1][u], ++corner[2][u], ++corner[2][w], ++corner[3][w];
    if (step < 0) std::swap(corner[1], corner[3]);
    add_quad(mesh.faces, id(corner[0]), id(corner[1]), id(corner[2]), id(corner[3]));
  };
  for (const auto& cell : cells)
    for (std::size_t axis : {0U, 1U, 2U})
      for (int step : {-1, 1}) add_side(cell, axis, step);
  return mesh;
}

/// A closed cube with 12 * 4^levels faces.
inline TriMesh cube(int levels = 0) {
  TriMesh mesh = voxel_surface({{0, 0, 0}});
  for (int k = 0; k < levels; ++k) mesh = subdivided(mesh);
  return mesh;
}

/// A bar with `holes` square holes: closed, genus = holes.
inline TriMesh pierced_bar(int holes) {
  std::set<std::array<int, 3>> cells;
  for (int x = 0; x < 2 * holes + 1; ++x)
    for (int y = 0; y < 3; ++y)
      if (x % 2 == 0 || y != 1) cells.insert({x, y, 0});
  return voxel_surface(cells);
}

/// The unit sphere from an octahedron: closed, genus 0, 8 * 4^levels faces.
inline TriMesh sphere(int levels) {
  TriMesh mesh{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
      {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}, {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}}};
  for (int k = 0; k < levels; ++k) mesh = subdivided(mesh);
  for (Vec3& p : mesh.positions) p.normalize();
  return mesh;
}

/// Two triangles that share one vertex.
inline TriMesh bow_tie() {
  return {{{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
}

/// A non-manifold edge.
inline TriMesh three_faces_at_an_edge() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
          {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}};
}

/// A bumpy, irregular height field with random diagonals: a disk of 2 * n * n faces.
inline TriMesh random_disk(Index n, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  TriMesh mesh = mapped_grid(n, n, Wrap::none, [&](double u, double v) {
    const double x = u + jitter(rng) / n, y = v + jitter(rng) / n;
    return Vec3(x, y, 0.3 * std::sin(5 * x) * std::cos(4 * y) + jitter(rng) / (2 * n));
  });
  for (std::size_t t = 0; t < mesh.faces.size(); t += 2) {
    if (rng() % 2 == 0) continue;
    const auto [a, b, c] = mesh.faces[t];
    const Index d = mesh.faces[t + 1][2];
    mesh.faces[t] = {a, b, d};
    mesh.faces[t + 1] = {b, c, d};
  }
  return mesh;
}

inline TriMesh merged(std::span<const TriMesh> meshes) {
  TriMesh all;
  for (const TriMesh& mesh : meshes) {
    const Index base = all.vertex_count();
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const auto& [a, b, c] : mesh.faces) all.faces.push_back({a + base, b + base, c + base});
  }
  return all;
}

inline TriMesh moved(TriMesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.positions) p += by;
  return mesh;
}

/// Gives every primitive vertices of its own, as glTF stores them.
inline Surface in_parts(const TriMesh& mesh, const std::vector<Index>& part) {
  Surface surface{{}, part, "test"};
  std::map<std::pair<Index, Index>, Index> number;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    Triangle face{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto key = std::pair(part[t], mesh.faces[t][i]);
      const auto [at, is_new] = number.try_emplace(key, surface.mesh.vertex_count());
      if (is_new) surface.mesh.positions.push_back(mesh.positions[mesh.faces[t][i]]);
      face[i] = at->second;
    }
    surface.mesh.faces.push_back(face);
  }
  return surface;
}

/// Every face with vertices of its own, as flat-shaded exports have it.
inline TriMesh soup(const TriMesh& mesh) {
  std::vector<Index> own(mesh.faces.size());
  std::iota(own.begin(), own.end(), 0);
  return in_parts(mesh, own).mesh;
}

/// The same surface with vertices and faces in another order, and faces starting at any corner.
inline TriMesh shuffled(const TriMesh& mesh, unsigned seed) {
  std::mt19937 rng(seed);
  std::vector<Index> number(mesh.positions.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), rng);
  TriMesh other{mesh.positions, mesh.faces};
  for (std::size_t v = 0; v < number.size(); ++v)
    other.positions[std::size_t(number[v])] = mesh.positions[v];
  for (Triangle& face : other.faces) {
    for (Index& v : face) v = number[std::size_t(v)];
    std::rotate(face.begin(), face.begin() + long(rng() % 3), face.end());
  }
  std::shuffle(other.faces.begin(), other.faces.end(), rng);
  return other;
}

/// As asset::read would hand it over: one primitive.
inline Surface surface_of(TriMesh mesh) {
  std::vector<Index> part(mesh.faces.size(), 0);
  return {std::move(mesh), std::move(part), "test"};
}

}  // namespace unwrapd::shapes
