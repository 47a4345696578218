#include "core/solve/metric.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {

EdgeLengths edge_lengths(const RestTriangle& triangle) {
  return {triangle.edge[0].norm(), triangle.edge[1].norm(), triangle.edge[2].norm()};
}

std::array<double, 3> corner_angles(const RestTriangle& triangle) {
  std::array<double, 3> angle{};
  for (std::size_t i = 0; i < 3; ++i) angle[(i + 2) % 3] = std::atan2(1.0, triangle.cot[i]);
  return angle;
}

std::vector<char> boundary_vertices(const Disk& disk) {
  std::vector<char> on(static_cast<std::size_t>(disk.vertex_count()), 0);
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) on[static_cast<std::size_t>(start_of(disk.faces, h))] = 1;
  return on;
}

std::vector<double> curvature(const Disk& disk, std::span<const RestTriangle> triangles) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  std::vector<double> k(on_boundary.size());
  for (std::size_t v = 0; v < k.size(); ++v)
    k[v] = (on_boundary[v] != 0 ? 1 : 2) * std::numbers::pi;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array<double, 3> angle = corner_angles(triangles[t]);
    for (std::size_t i = 0; i < 3; ++i) k[static_cast<std::size_t>(disk.faces[t][i])] -= angle[i];
  }
  return k;
}

double inner_curvature(const Disk& disk, std::span<const double> curvature) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  double greatest = 0;
  for (std::size_t v = 0; v < curvature.size(); ++v)
    if (on_boundary[v] == 0) greatest = std::max(greatest, std::abs(curvature[v]));
  return greatest;
}

SparseMatrix cotan_laplacian(const Disk& disk, std::span<const RestTriangle> triangles) {
  std::vector<double> weight;
  weight.reserve(3 * triangles.size());
  for (const RestTriangle& t : triangles)
    for (double cot : t.cot) weight.push_back(cot / 2);
  return lower_laplacian(disk.faces, disk.vertex_count(), weight);
}

std::vector<double> flat_scales(const Disk& disk, const SparseMatrix& laplacian,
                                std::span<const double> curvature) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  const FreeVertices free = number_free(on_boundary);
  std::vector<double> u(on_boundary.size(), 0.0);
  if (free.count == 0) return u;
  const std::vector<Vec2> zero(u.size(), Vec2::Zero());
  auto [lower, rhs] = eliminate<SparseMatrix, Vec2>(laplacian, free, zero);
  for (std::size_t v = 0; v < u.size(); ++v)
    if (free.slot[v] != kFixed) rhs[static_cast<std::size_t>(free.slot[v])].x() = -curvature[v];
  factor(lower)->solve(rhs);
  for (std::size_t v = 0; v < u.size(); ++v)
    if (free.slot[v] != kFixed) u[v] = rhs[static_cast<std::size_t>(free.slot[v])].x();
  return u;
}

}  // namespace unwrapd
