// Eq. (4): sum_j [cot + cot](u_i - u_j) = sum_j [cot L + cot L](x_i - x_j) for every vertex i.
// The matrix is a sum of positive semidefinite element matrices whatever the cotangents' signs; its
// only null space is translation. Fixed vertices are eliminated and springs add to the diagonal:
// either removes that null space. Where nothing is held, adding the diagonal entry of vertex 0 once
// more does, and leaves the solution exact, because the right-hand side adds up to zero.
#include "core/solve/global_step.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

#include "core/cancel.hpp"
#include "core/linear/solve_panels.hpp"
#include "core/solve/kept.hpp"

namespace unwrapd {
namespace {

SparseMatrix held_matrix(const Disk& disk, const Holds& holds, Executor& executor) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const RestTriangle& rest : disk.rest)
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  throw_if_cancelled(disk.stop);
  SparseMatrix lower = lower_laplacian(disk.faces, disk.vertex_count(), weight, executor);
  for (const Spring& spring : holds.springs)
    lower.coeffRef(spring.vertex, spring.vertex) += 2 * spring.weight;
  if (holds.empty()) lower.coeffRef(0, 0) *= 2;
  return lower;
}

SparseMatrix free_matrix(const Disk& disk, const Holds& holds, const FreeVertices& free,
                         Executor& executor) {
  SparseMatrix lower = held_matrix(disk, holds, executor);
  if (holds.fixed.empty()) return lower;
  const std::vector<Vec2> nowhere(free.slot.size(), Vec2::Zero());  // only the matrix is wanted
  return eliminate<SparseMatrix, Vec2>(lower, free, nowhere, disk.stop).lower;
}

std::shared_ptr<const Factor> factored(const Disk& disk, const Holds& holds,
                                       const FreeVertices& free, Executor& executor) {
  const SparseMatrix lower = free_matrix(disk, holds, free, executor);
  throw_if_cancelled(executor.stop());
  const Content pattern = Content("analysis").add(disk.connectivity).add(free.slot);
  const auto analysis = kept(disk, pattern, [&] {
    return disk.is_ordered ? analyse_in_order(lower, disk.stop) : analyse(lower, disk.stop);
  });
  throw_if_cancelled(executor.stop());
  check_memory(disk, analysis->job_bytes());
  return definite(try_factor(analysis, lower, executor));
}

std::vector<Index> ranks(const FreeVertices& free, std::span<const Index> position) {
  std::vector<Index> rank;
  rank.reserve(free.slot.size());
  Index next_fixed = free.count;
  for (const Index slot : free.slot)
    rank.push_back(slot == kFixed ? next_fixed++ : position[static_cast<std::size_t>(slot)]);
  return rank;
}

}  // namespace

std::vector<Vec2> by_rank(std::span<const Vec2> by_vertex, std::span<const Index> rank) {
  std::vector<Vec2> sorted(rank.size());
  for (std::size_t v = 0; v < rank.size(); ++v)
    sorted[static_cast<std::size_t>(rank[v])] = by_vertex[v];
  return sorted;
}

std::vector<Vec2> by_vertex(std::span<const Vec2> by_rank, std::span<const Index> rank) {
  std::vector<Vec2> sorted(rank.size());
  for (std::size_t v = 0; v < rank.size(); ++v)
    sorted[v] = by_rank[static_cast<std::size_t>(rank[v])];
  return sorted;
}

GlobalStep::GlobalStep(const Disk& disk, const Holds& holds, Executor* executor)
    : free_(free_vertices(disk.positions.size(), holds)), executor_(executor) {
  if (free_.count == 0) {
    rank_ = ranks(free_, {});
    return;
  }
  std::vector<Index> spring;
  std::vector<double> weight;
  for (const Spring& s : holds.springs) spring.push_back(s.vertex), weight.push_back(s.weight);
  const Content content =
      Content("global step").add(disk.content).add(free_.slot).add(spring).add(weight);
  system_ = kept(disk, content, [&] { return factored(disk, holds, free_, this->executor()); });
  rank_ = ranks(free_, system_->analysis()->nodes.position);
}

void GlobalStep::solve(std::span<Vec2> force) const {
  std::vector<Vec2> sorted = by_rank(force, rank_);
  solve_by_rank(sorted);
  for (std::size_t v = 0; v < force.size(); ++v)
    force[v] = sorted[static_cast<std::size_t>(rank_[v])];
}

void GlobalStep::solve_by_rank(std::span<Vec2> force) const {
  assert(force.size() == rank_.size());
  throw_if_cancelled(executor().stop());
  const auto free_count = static_cast<std::size_t>(free_.count);
  if (system_) system_->solve_in_order(force.first(free_count), executor());
  std::ranges::fill(force.subspan(free_count), Vec2::Zero());
}

void GlobalStep::descend_by_rank(std::span<Vec2> force, std::span<const char> over) const {
  assert(free_.count == static_cast<Index>(force.size()));
  throw_if_cancelled(executor().stop());
  system_->descend_in_order(force, over, executor());
}

void GlobalStep::ascend_by_rank(std::span<Vec2> force, std::span<const char> over) const {
  assert(free_.count == static_cast<Index>(force.size()));
  throw_if_cancelled(executor().stop());
  system_->ascend_in_order(force, over, executor());
}

std::vector<char> GlobalStep::over(std::span<const Index> ranks) const {
  return supernodes_over(*system_->analysis(), ranks);
}

void GlobalStep::solve_alike(const SparseMatrix& lower, std::span<Vec2> b) const {
  assert(free_.count == static_cast<Index>(b.size()));
  throw_if_cancelled(executor().stop());
  const auto other = definite(try_factor(system_->analysis(), lower, executor()));
  throw_if_cancelled(executor().stop());
  other->solve(b, executor());
  throw_if_cancelled(executor().stop());
}

}  // namespace unwrapd
