// The conformal energy is Hermitian in z = u_x + i u_y, n by n instead of 2n by 2n:
//   4 E(z) = z* H z,  H = L - 4 M,
// L the cotangent Laplacian (z* L z = 2 sum A_t |J_t|^2) and M the area form (z* M z = sum of
// A_t det J_t), which only lives on the boundary: each boundary half-edge (i, j), the surface to
// its left, adds Im(conj(z_i) z_j) / 2. A soft constraint w |z_v - p|^2 adds 4 w to H_vv and 4 w p
// to the right-hand side; fixed vertices are eliminated.
#include "core/solve/maps/conformal_system.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/solve/base/cached.hpp"

namespace unwrapd::solve::maps {
namespace {

constexpr linear::Complex kI(0, 1);

/// Bending a ribbon a million times longer than wide costs less energy than rounding, so that H is
/// indefinite in double precision. Adding a multiple of L, which penalizes lengths, makes it
/// definite again.
constexpr double kLeastSoftening = 1e-12, kMostSoftening = 1e-2;

std::pair<Index, Index> ends(const Disk& disk, Index h) {
  const Triangle& face = disk.faces[static_cast<std::size_t>(h / 3)];
  return {face[static_cast<std::size_t>(h % 3)], face[static_cast<std::size_t>((h + 1) % 3)]};
}

linear::Complex as_complex(const Vec2& u) { return {u.x(), u.y()}; }

}  // namespace

linear::ComplexMatrix conformal_matrix(const Disk& disk, double softening) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const measure::RestTriangle& rest : disk.rest)
    for (double cot : rest.cot) weight.push_back((1 + softening) * cot);
  linear::ComplexMatrix lower =
      linear::lower_laplacian(disk.faces, disk.vertex_count(), weight, disk.stop)
          .cast<linear::Complex>();
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) {
      const auto [i, j] = ends(disk, h);
      if (i > j)
        lower.coeffRef(i, j) += kI;  // H_ij += i
      else
        lower.coeffRef(j, i) -= kI;  // H_ji = conj(H_ij)
    }
  return lower;
}

std::unique_ptr<linear::HermitianSystem> try_softened(const linear::ComplexMatrix& lower,
                                                      double softening,
                                                      const linear::MemoryCheck& check,
                                                      const std::stop_token& stop) {
  std::unique_ptr<linear::HermitianSystem> system = linear::try_factor(lower, check, stop);
  return softening < kMostSoftening ? std::move(system) : linear::definite(std::move(system));
}

double more_softening(double softening) { return std::max(100 * softening, kLeastSoftening); }

bool ConformalSystem::try_build(const Disk& disk, const VertexConstraints& constraints,
                                double softening, bool may_throw) {
  stop_ = disk.stop;
  lower_ = conformal_matrix(disk, softening);
  for (const SoftConstraint& soft_constraint : constraints.soft)
    lower_.coeffRef(soft_constraint.vertex, soft_constraint.vertex) += 4 * soft_constraint.weight;
  free_ = free_vertices(disk.positions.size(), constraints);
  if (free_.count == 0) return true;
  const std::vector<linear::Complex> nowhere(free_.slot.size());  // only the matrix is needed
  const auto reduced =
      linear::eliminate<linear::ComplexMatrix, linear::Complex>(lower_, free_, nowhere, stop_);
  const auto check = [&](std::size_t bytes) { check_memory(disk, bytes); };
  system_ = may_throw ? try_softened(reduced.lower, softening, check, disk.stop)
                      : linear::try_factor(reduced.lower, check, disk.stop);
  return system_ != nullptr;
}

ConformalSystem::ConformalSystem(const Disk& disk, const VertexConstraints& constraints) {
  assert(constraints.count() >= 2);
  for (double softening = 0; !try_build(disk, constraints, softening, true);)
    softening = more_softening(softening);
}

std::optional<ConformalSystem> ConformalSystem::exact(const Disk& disk,
                                                      const VertexConstraints& constraints) {
  ConformalSystem system;
  if (!system.try_build(disk, constraints, 0, false)) return std::nullopt;
  return system;
}

UvMap ConformalSystem::solve(const VertexConstraints& constraints) const {
  using Vector = Eigen::Matrix<linear::Complex, Eigen::Dynamic, 1>;
  Vector z = Vector::Zero(lower_.cols());
  for (const HardConstraint& point : constraints.hard) z[point.vertex] = as_complex(point.at);
  Vector pull = -(lower_.selfadjointView<Eigen::Lower>() * z);
  for (const SoftConstraint& soft_constraint : constraints.soft)
    pull[soft_constraint.vertex] += 4 * soft_constraint.weight * as_complex(soft_constraint.at);
  std::vector<linear::Complex> rhs(static_cast<std::size_t>(free_.count));
  for (std::size_t v = 0; v < free_.slot.size(); ++v)
    if (free_.slot[v] != linear::kFixed)
      rhs[static_cast<std::size_t>(free_.slot[v])] = pull[static_cast<Eigen::Index>(v)];
  if (system_) system_->solve(rhs, stop_);
  UvMap uv;
  uv.reserve(free_.slot.size());
  for (std::size_t v = 0; v < free_.slot.size(); ++v) {
    const linear::Complex& u = free_.slot[v] == linear::kFixed
                                   ? z[static_cast<Eigen::Index>(v)]
                                   : rhs[static_cast<std::size_t>(free_.slot[v])];
    uv.emplace_back(u.real(), u.imag());
  }
  return uv;
}

}  // namespace unwrapd::solve::maps
