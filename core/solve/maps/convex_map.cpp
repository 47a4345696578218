// Equal weights give a symmetric system. Mean-value weights do not: their M-matrix has a dominant
// diagonal and a symmetric pattern, and is solved by LU without pivoting.
#include "core/solve/maps/convex_map.hpp"

#include <cassert>
#include <cmath>

#include "core/base/cancel.hpp"
#include "core/linear/dominant_lu.hpp"
#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "core/solve/base/cached.hpp"
#include "core/solve/maps/boundary_shape.hpp"

namespace unwrapd::solve::maps {
namespace {

/// The fixed boundary, and the numbers of the inner vertices, which are the unknowns.
struct ConvexMap {
  linear::FreeVertices inner;
  UvMap uv;  ///< all vertices; inner ones are at the origin
};

ConvexMap with_boundary(const Disk& disk, std::span<const HardConstraint> boundary) {
  ConvexMap map{{}, UvMap(disk.positions.size(), Vec2::Zero())};
  std::vector<char> hard(disk.positions.size(), 0);
  for (const HardConstraint& point : boundary) {
    hard[static_cast<std::size_t>(point.vertex)] = 1;
    map.uv[static_cast<std::size_t>(point.vertex)] = point.at;
  }
  map.inner = linear::number_free(hard);
  return map;
}

void place_inner(std::span<const Vec2> solution, ConvexMap& map) {
  for (std::size_t v = 0; v < map.uv.size(); ++v)
    if (map.inner.slot[v] != linear::kFixed)
      map.uv[v] = solution[static_cast<std::size_t>(map.inner.slot[v])];
}

/// tan(angle / 2) at corner i of a rest triangle, from the cotangent, without cancellation.
double half_angle_tangent(const measure::RestTriangle& rest, std::size_t corner) {
  const double cot = rest.cot[(corner + 1) % 3];
  const double root = std::sqrt(1 + cot * cot);
  return cot > 0 ? 1 / (root + cot) : root - cot;
}

struct LinearSystem {
  linear::SparseMatrix matrix;
  std::vector<Vec2> rhs;
};

/// Rows of the inner vertices: sum_j w_ij (u_i - u_j) = 0, with
/// w_ij = (tan(alpha / 2) + tan(beta / 2)) / |x_i - x_j|, alpha and beta the angles at i.
LinearSystem mean_value_system(const Disk& disk, const ConvexMap& map) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(12 * disk.faces.size());
  std::vector<Vec2> rhs(static_cast<std::size_t>(map.inner.count), Vec2::Zero());
  const auto couple = [&](Index i, Index j, double w) {
    const Index row = map.inner.slot[static_cast<std::size_t>(i)];
    const Index column = map.inner.slot[static_cast<std::size_t>(j)];
    if (row == linear::kFixed) return;
    entries.emplace_back(row, row, w);
    if (column == linear::kFixed)
      rhs[static_cast<std::size_t>(row)] += w * map.uv[static_cast<std::size_t>(j)];
    else
      entries.emplace_back(row, column, -w);
  };
  for (std::size_t t = 0; t < disk.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      check_cancelled_every(3 * t + i, disk.stop);
      const measure::RestTriangle& rest = disk.rest[t];
      const Triangle& face = disk.faces[t];
      const double tangent = half_angle_tangent(rest, i);
      couple(face[i], face[(i + 1) % 3], tangent / rest.edge[i].norm());
      couple(face[i], face[(i + 2) % 3], tangent / rest.edge[(i + 2) % 3].norm());
    }
  LinearSystem system{{}, std::move(rhs)};
  system.matrix.resize(map.inner.count, map.inner.count);
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  return system;
}

}  // namespace

UvMap tutte_map(const Disk& disk) {
  constexpr auto kMake = [](const Disk& d) {
    return tutte_map(d, boundary_points(d, BoundaryShape::circle));
  };
  return cached_of_disk<kMake>(disk);
}

UvMap mean_value_map(const Disk& disk) {
  constexpr auto kMake = [](const Disk& d) {
    return mean_value_map(d, boundary_points(d, BoundaryShape::circle));
  };
  return cached_of_disk<kMake>(disk);
}

UvMap tutte_map(const Disk& disk, std::span<const HardConstraint> boundary) {
  ConvexMap map = with_boundary(disk, boundary);
  const std::vector<double> equal(3 * disk.faces.size(), 1.0);
  const linear::SparseMatrix lower =
      linear::lower_laplacian(disk.faces, disk.vertex_count(), equal, disk.stop);
  auto reduced = linear::eliminate<linear::SparseMatrix, Vec2>(lower, map.inner, map.uv, disk.stop);
  if (map.inner.count > 0) linear::factor(reduced.lower, disk.stop)->solve(reduced.rhs, disk.stop);
  place_inner(reduced.rhs, map);
  return std::move(map.uv);
}

UvMap mean_value_map(const Disk& disk, std::span<const HardConstraint> boundary) {
  ConvexMap map = with_boundary(disk, boundary);
  LinearSystem system = mean_value_system(disk, map);
  if (map.inner.count > 0) linear::solve_dominant(system.matrix, system.rhs, disk.stop);
  place_inner(system.rhs, map);
  return std::move(map.uv);
}

}  // namespace unwrapd::solve::maps
