#include "core/solve/base/metric.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/edges.hpp"

namespace unwrapd::solve {

EdgeLengths edge_lengths(const measure::RestTriangle& triangle) {
  return {triangle.edge[0].norm(), triangle.edge[1].norm(), triangle.edge[2].norm()};
}

std::array<double, 3> corner_angles(const measure::RestTriangle& triangle) {
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

std::vector<double> curvature(const Disk& disk, std::span<const measure::RestTriangle> triangles,
                              Executor& executor) {
  std::vector<std::array<double, 3>> angles(triangles.size());
  for_each_part(angles.size(), executor, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) angles[t] = corner_angles(triangles[t]);
  });
  const std::vector<char> on_boundary = boundary_vertices(disk);
  std::vector<double> k(on_boundary.size());
  for (std::size_t v = 0; v < k.size(); ++v)
    k[v] = (on_boundary[v] != 0 ? 1 : 2) * std::numbers::pi;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    for (std::size_t i = 0; i < 3; ++i)
      k[static_cast<std::size_t>(disk.faces[t][i])] -= angles[t][i];
  }
  return k;
}

std::vector<double> curvature(const Disk& disk, std::span<const measure::RestTriangle> triangles) {
  SerialExecutor serial;
  return curvature(disk, triangles, serial);
}

double inner_curvature(const Disk& disk, std::span<const double> curvature) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  double greatest = 0;
  for (std::size_t v = 0; v < curvature.size(); ++v)
    if (on_boundary[v] == 0) greatest = std::max(greatest, std::abs(curvature[v]));
  return greatest;
}

linear::SparseMatrix cotan_laplacian(const Disk& disk,
                                     std::span<const measure::RestTriangle> triangles) {
  std::vector<double> weight;
  weight.reserve(3 * triangles.size());
  for (const measure::RestTriangle& t : triangles)
    for (double cot : t.cot) weight.push_back(cot / 2);
  return linear::lower_laplacian(disk.faces, disk.vertex_count(), weight, disk.stop);
}

std::vector<double> product(const linear::SparseMatrix& laplacian, std::span<const double> x) {
  std::vector<double> y(x.size(), 0.0);
  for (Index j = 0; j < static_cast<Index>(laplacian.cols()); ++j)
    for (linear::SparseMatrix::InnerIterator it(laplacian, j); it; ++it) {
      const auto row = static_cast<std::size_t>(it.row()), column = static_cast<std::size_t>(j);
      y[row] += it.value() * x[column];
      if (row != column) y[column] += it.value() * x[row];
    }
  return y;
}

InnerSystem::InnerSystem(const Disk& disk, const linear::SparseMatrix& lower)
    : inner_(linear::number_free(boundary_vertices(disk))), stop_(disk.stop) {
  if (inner_.count == 0) return;
  const std::vector<Vec2> zero(disk.positions.size(), Vec2::Zero());
  system_ = linear::factor(
      linear::eliminate<linear::SparseMatrix, Vec2>(lower, inner_, zero, stop_).lower, stop_);
  for (Index j = 0; j < static_cast<Index>(lower.cols()); ++j) {
    check_cancelled_every(j, stop_);
    for (linear::SparseMatrix::InnerIterator it(lower, j); it; ++it) {
      const auto i = static_cast<Index>(it.row());
      const Index row = inner_.slot[static_cast<std::size_t>(i)];
      const Index column = inner_.slot[static_cast<std::size_t>(j)];
      if (row != linear::kFixed && column == linear::kFixed)
        coupling_.push_back({row, j, it.value()});
      if (row == linear::kFixed && column != linear::kFixed)
        coupling_.push_back({column, i, it.value()});
    }
  }
}

void InnerSystem::solve(std::span<Vec2> x) const {
  if (inner_.count == 0) return;
  std::vector<Vec2> rhs(static_cast<std::size_t>(inner_.count));
  for (std::size_t v = 0; v < x.size(); ++v)
    if (inner_.slot[v] != linear::kFixed) rhs[static_cast<std::size_t>(inner_.slot[v])] = x[v];
  for (const Coupling& c : coupling_)
    rhs[static_cast<std::size_t>(c.row)] -= c.value * x[static_cast<std::size_t>(c.boundary)];
  system_->solve(rhs, stop_);
  for (std::size_t v = 0; v < x.size(); ++v)
    if (inner_.slot[v] != linear::kFixed) x[v] = rhs[static_cast<std::size_t>(inner_.slot[v])];
}

std::vector<double> flat_scales(const Disk& disk, const InnerSystem& inner,
                                std::span<const double> curvature) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  std::vector<Vec2> x(curvature.size(), Vec2::Zero());
  for (std::size_t v = 0; v < x.size(); ++v)
    if (on_boundary[v] == 0) x[v].x() = -curvature[v];
  inner.solve(x);
  std::vector<double> u;
  u.reserve(x.size());
  for (const Vec2& value : x) u.push_back(value.x());
  return u;
}

}  // namespace unwrapd::solve
