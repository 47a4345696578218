// Eq. (4): sum_j [cot + cot](u_i - u_j) = sum_j [cot L + cot L](x_i - x_j) for every vertex i.
// The matrix is a sum of positive semidefinite element matrices whatever the cotangents' signs; its
// only null space is translation. Fixed vertices are eliminated and springs add to the diagonal:
// either removes that null space. Where nothing is held, adding the diagonal entry of vertex 0 once
// more does, and leaves the solution exact, because the right-hand side adds up to zero.
#include "core/solve/global_step.hpp"

#include <cassert>
#include <vector>

namespace unwrapd {
namespace {

SparseMatrix held_matrix(const Disk& disk, const Holds& holds) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const RestTriangle& rest : disk.rest)
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  SparseMatrix lower = lower_laplacian(disk.faces, disk.vertex_count(), weight);
  for (const Spring& spring : holds.springs)
    lower.coeffRef(spring.vertex, spring.vertex) += 2 * spring.weight;
  if (holds.empty()) lower.coeffRef(0, 0) *= 2;
  return lower;
}

}  // namespace

GlobalStep::GlobalStep(const Disk& disk, const Holds& holds)
    : free_(free_vertices(disk.positions.size(), holds)) {
  const SparseMatrix lower = held_matrix(disk, holds);
  if (holds.fixed.empty()) {
    system_ = factor(lower);
  } else if (free_.count > 0) {
    const std::vector<Vec2> nowhere(free_.slot.size(), Vec2::Zero());  // only the matrix is wanted
    system_ = factor(eliminate<SparseMatrix, Vec2>(lower, free_, nowhere).lower);
  }
}

void GlobalStep::solve(std::span<Vec2> force) const {
  assert(force.size() == free_.slot.size());
  if (free_.count == static_cast<Index>(force.size())) return system_->solve(force);
  std::vector<Vec2> change(static_cast<std::size_t>(free_.count));
  for (std::size_t v = 0; v < force.size(); ++v)
    if (free_.slot[v] != kFixed) change[static_cast<std::size_t>(free_.slot[v])] = force[v];
  if (system_) system_->solve(change);
  for (std::size_t v = 0; v < force.size(); ++v)
    force[v] = free_.slot[v] == kFixed ? Vec2(Vec2::Zero())
                                       : change[static_cast<std::size_t>(free_.slot[v])];
}

}  // namespace unwrapd
