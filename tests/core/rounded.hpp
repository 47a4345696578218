#pragma once
// Meshes as careless exporters write them: every face has its own vertices, which are rounded, and
// is wound at random. Each vertex knows the vertex of the mesh that it stands for.

#include <random>
#include <utility>
#include <vector>

#include "tests/core/shapes.hpp"

namespace unwrapd::shapes {

/// A mesh, and for each of its vertices the vertex of the exact mesh.
struct Rounded {
  TriMesh mesh;
  std::vector<Index> exact;
  std::vector<char> is_turned = {};  ///< of each face
};

inline double diagonal(const TriMesh& mesh) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

/// Moves every vertex by up to `noise` of the mesh's diagonal along each axis.
inline void add_noise(double noise, unsigned seed, TriMesh& mesh) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> along(-1, 1);
  const double most = noise * diagonal(mesh);
  for (Vec3& p : mesh.positions) p += most * Vec3(along(rng), along(rng), along(rng));
}

/// Every face with vertices of its own.
inline Rounded apart(const TriMesh& mesh) {
  Rounded soup{{{}, {}}, {}};
  for (const Triangle& face : mesh.faces) {
    const Index first = soup.mesh.vertex_count();
    soup.mesh.faces.push_back({first, first + 1, first + 2});
    for (const Index v : face) {
      soup.mesh.positions.push_back(mesh.positions[std::size_t(v)]);
      soup.exact.push_back(v);
    }
  }
  return soup;
}

/// apart(), with noise.
inline Rounded rounded_soup(const TriMesh& mesh, double noise, unsigned seed) {
  Rounded soup = apart(mesh);
  add_noise(noise, seed, soup.mesh);
  return soup;
}

/// apart(), moved a little from face to face and then written with so many decimals.
inline Rounded decimal_soup(const TriMesh& mesh, int decimals, unsigned seed) {
  const double unit = std::pow(10.0, -decimals);
  Rounded soup = rounded_soup(mesh, unit / 2 / diagonal(mesh), seed);
  for (Vec3& p : soup.mesh.positions)
    for (double& x : p) x = std::round(x / unit) * unit;
  return soup;
}

/// Reverses the winding of faces, each with this probability.
inline void wind_at_random(double probability, unsigned seed, Rounded& soup) {
  std::mt19937 rng(seed);
  std::bernoulli_distribution turns(probability);
  soup.is_turned.assign(soup.mesh.faces.size(), 0);
  for (std::size_t t = 0; t < soup.mesh.faces.size(); ++t)
    if (turns(rng)) {
      std::swap(soup.mesh.faces[t][1], soup.mesh.faces[t][2]);
      soup.is_turned[t] = 1;
    }
}

/// A flat square of n x n quads, n >= 4, with a slit of `width` along its middle row: n - 3
/// vertices have a copy on its other side, its ends are away from the border.
inline TriMesh slit_square(Index n, double width) {
  TriMesh mesh = grid(n, n);
  const Index row = n / 2;
  for (Index i = 2; i < n - 1; ++i) {
    const Index v = i + row * (n + 1), copy = mesh.vertex_count();
    mesh.positions.push_back(mesh.positions[std::size_t(v)] + Vec3(0, width, 0));
    for (std::size_t t = std::size_t(2 * n * row); t < std::size_t(2 * n * (row + 1)); ++t)
      for (Index& corner : mesh.faces[t])
        if (corner == v) corner = copy;
  }
  return mesh;
}

/// Both meshes as one.
inline TriMesh together(const TriMesh& a, const TriMesh& b) {
  TriMesh both = a;
  for (Triangle face : b.faces) {
    for (Index& v : face) v += a.vertex_count();
    both.faces.push_back(face);
  }
  both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
  return both;
}

inline TriMesh moved(TriMesh mesh, double scale, const Vec3& by) {
  for (Vec3& p : mesh.positions) p = scale * p + by;
  return mesh;
}

/// A square and its other side at this distance, both with a border: an open thin wall.
inline TriMesh thin_wall(Index n, double distance) {
  const TriMesh front = grid(n, n);
  TriMesh back = moved(front, 1, Vec3(0, 0, -distance));
  for (Triangle& face : back.faces) std::swap(face[1], face[2]);
  return together(front, back);
}

/// n x n square tiles of side 1 with gaps, beside a square that is `size` times as wide as the
/// tiles.
inline TriMesh tiles(Index n, double gap, double size) {
  TriMesh all = moved(grid(4, 4), size * n, Vec3(0, 2 * n, 0));
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      all = together(all, moved(grid(1, 1), 1, Vec3((1 + gap) * i, (1 + gap) * j, 0)));
  return all;
}

}  // namespace unwrapd::shapes
