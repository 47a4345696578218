#include "tests/bench/cp_as_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "core/solve/base/metric.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/maps/fill_holes.hpp"

namespace unwrapd::bench {
namespace {

/// One equation: the sum of coefficient[i] z[vertex[i]] is 0.
struct Row {
  std::array<Index, 3> vertex;
  std::array<linear::Complex, 3> coefficient;
};

std::size_t index(Index v) { return static_cast<std::size_t>(v); }

solve::EdgeLengths scaled(const solve::Disk& disk, std::span<const double> u, std::size_t t) {
  solve::EdgeLengths l = solve::edge_lengths(disk.rest[t]);
  const Triangle& face = disk.faces[t];
  for (std::size_t i = 0; i < 3; ++i)
    l[i] *= (std::exp(u[index(face[i])]) + std::exp(u[index(face[(i + 1) % 3])])) / 2;
  return l;
}

Row row_of(const Triangle& face, const solve::EdgeLengths& l) {
  const double to_j = l[2], to_i = l[1], across = l[0];
  const double cosine =
      std::clamp((to_j * to_j + to_i * to_i - across * across) / (2 * to_j * to_i), -1.0, 1.0);
  const linear::Complex r = to_i / to_j * linear::Complex(cosine, std::sqrt(1 - cosine * cosine));
  const double size = std::sqrt(to_j * to_j + to_i * to_i + across * across) / to_j;
  return {{face[2], face[0], face[1]}, {(r - 1.0) / size, -r / size, 1.0 / size}};
}

std::vector<Row> rows_of(const solve::Disk& disk, std::span<const double> u) {
  std::vector<Row> rows;
  for (std::size_t t = 0; t < disk.faces.size(); ++t)
    rows.push_back(row_of(disk.faces[t], scaled(disk, u, t)));
  return rows;
}

linear::ComplexMatrix normal_matrix(std::span<const Row> rows, Index vertex_count) {
  std::vector<Eigen::Triplet<linear::Complex, Index>> entries;
  for (const Row& row : rows)
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        if (row.vertex[a] >= row.vertex[b])
          entries.emplace_back(row.vertex[a], row.vertex[b],
                               std::conj(row.coefficient[a]) * row.coefficient[b]);
  linear::ComplexMatrix lower(vertex_count, vertex_count);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

/// The least-squares solution with one vertex held at 0 and another at 1.
UvMap least_squares(std::span<const Row> rows, Index vertex_count,
                    std::array<Index, 2> constrained) {
  std::vector<char> is_held(index(vertex_count), 0);
  std::vector<linear::Complex> z(is_held.size());
  for (Index v : constrained) is_held[index(v)] = 1;
  z[index(constrained[1])] = 1;
  const linear::FreeVertices free = linear::number_free(is_held);
  auto reduced = linear::eliminate<linear::ComplexMatrix, linear::Complex>(
      normal_matrix(rows, vertex_count), free, z);
  linear::factor(reduced.lower)->solve(reduced.rhs);
  UvMap uv;
  for (std::size_t v = 0; v < z.size(); ++v) {
    const linear::Complex& at =
        free.slot[v] == linear::kFixed ? z[v] : reduced.rhs[index(free.slot[v])];
    uv.emplace_back(at.real(), at.imag());
  }
  return uv;
}

}  // namespace

UvMap cp_as_run(const solve::Disk& disk) {
  const solve::maps::FilledDisk filled = solve::maps::fill_holes(disk);
  const solve::InnerSystem inner(filled.disk,
                                 solve::cotan_laplacian(filled.disk, filled.disk.rest));
  const std::vector<double> u =
      solve::flat_scales(filled.disk, inner, solve::curvature(filled.disk, filled.disk.rest));
  UvMap uv = least_squares(rows_of(filled.disk, u), filled.disk.vertex_count(),
                           solve::maps::diameter(disk.positions));
  uv.resize(disk.positions.size());
  return uv;
}

}  // namespace unwrapd::bench
