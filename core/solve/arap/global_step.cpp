// Eq. (4): sum_j [cot + cot](u_i - u_j) = sum_j [cot L + cot L](x_i - x_j) for every vertex i.
// The matrix is a sum of positive semidefinite element matrices whatever the cotangents' signs; its
// only null space is translation. Fixed vertices are eliminated and soft constraints add to the
// diagonal: either removes that null space. Where nothing is held, adding the diagonal entry of
// vertex 0 once more does, and leaves the solution exact, because the right-hand side adds up to
// zero.
#include "core/solve/arap/global_step.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/linear/solve_panels.hpp"
#include "core/solve/base/cached.hpp"

namespace unwrapd::solve::arap {
namespace {

linear::SparseMatrix held_matrix(const Disk& disk, const ConstraintPattern& constrained,
                                 Executor& executor) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const measure::RestTriangle& rest : disk.rest)
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  throw_if_cancelled(disk.stop);
  linear::SparseMatrix lower =
      linear::lower_laplacian(disk.faces, disk.vertex_count(), weight, executor);
  for (std::size_t k = 0; k < constrained.soft_constraint.size(); ++k)
    lower.coeffRef(constrained.soft_constraint[k], constrained.soft_constraint[k]) +=
        2 * constrained.weight[k];
  if (constrained.is_empty()) lower.coeffRef(0, 0) *= 2;
  return lower;
}

linear::SparseMatrix free_matrix(const Disk& disk, const ConstraintPattern& constrained,
                                 Executor& executor) {
  linear::SparseMatrix lower = held_matrix(disk, constrained, executor);
  const std::size_t count = constrained.free.slot.size();
  if (static_cast<std::size_t>(constrained.free.count) == count) return lower;
  const std::vector<Vec2> nowhere(count, Vec2::Zero());  // only the matrix is wanted
  return linear::eliminate<linear::SparseMatrix, Vec2>(lower, constrained.free, nowhere, disk.stop)
      .lower;
}

std::shared_ptr<const linear::Analysis> make_analysis(const CacheContext& by,
                                                      const linear::SparsePattern& lower,
                                                      bool is_ordered) {
  return is_ordered ? linear::analyse_in_order(lower, by.stop) : linear::analyse(lower, by.stop);
}

std::shared_ptr<const linear::Factor> make_factor(const CacheContext& by, const Disk& disk,
                                                  const ConstraintPattern& constrained) {
  const linear::SparseMatrix lower = free_matrix(disk, constrained, *by.executor);
  throw_if_cancelled(by.executor->stop());
  const auto analysis = cached<make_analysis>(by, linear::SparsePattern(lower), disk.is_ordered);
  throw_if_cancelled(by.executor->stop());
  check_memory(disk, analysis->job_bytes());
  return linear::definite(linear::try_factor(analysis, lower, *by.executor));
}

std::vector<Index> ranks(const linear::FreeVertices& free, std::span<const Index> position) {
  std::vector<Index> rank;
  rank.reserve(free.slot.size());
  Index next_fixed = free.count;
  for (const Index slot : free.slot)
    rank.push_back(slot == linear::kFixed ? next_fixed++
                                          : position[static_cast<std::size_t>(slot)]);
  return rank;
}

}  // namespace

ConstraintPattern::ConstraintPattern(std::size_t vertex_count, const VertexConstraints& constraints)
    : free(free_vertices(vertex_count, constraints)) {
  for (const SoftConstraint& s : constraints.soft)
    soft_constraint.push_back(s.vertex), weight.push_back(s.weight);
}

bool ConstraintPattern::is_empty() const {
  return static_cast<std::size_t>(free.count) == free.slot.size() && soft_constraint.empty();
}

void describe(CacheKey& key, const ConstraintPattern& constrained) {
  const auto& [free, soft_constraint, weight] = constrained;
  key.add(free.slot).add(soft_constraint).add(weight);
}

void describe(CacheKey& key, const GlobalStep& global) { key.add(global.made_of()); }

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

GlobalStep::GlobalStep(const Disk& disk, const VertexConstraints& constraints, Executor* executor)
    : held_(disk.positions.size(), constraints), executor_(executor) {
  if (disk.core != nullptr) made_of_ = key_of<make_factor>(*disk.core, disk, held_);
  if (held_.free.count == 0) {
    rank_ = ranks(held_.free, {});
    return;
  }
  system_ = cached<make_factor>(CacheContext{disk.core, disk.stop, &this->executor()}, disk, held_);
  rank_ = ranks(held_.free, system_->analysis()->nodes.position);
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
  const auto free_count = static_cast<std::size_t>(held_.free.count);
  if (system_) system_->solve_in_order(force.first(free_count), executor());
  std::ranges::fill(force.subspan(free_count), Vec2::Zero());
}

void GlobalStep::descend_by_rank(std::span<Vec2> force, std::span<const char> over) const {
  assert(held_.free.count == static_cast<Index>(force.size()));
  throw_if_cancelled(executor().stop());
  system_->descend_in_order(force, over, executor());
}

void GlobalStep::ascend_by_rank(std::span<Vec2> force, std::span<const char> over) const {
  assert(held_.free.count == static_cast<Index>(force.size()));
  throw_if_cancelled(executor().stop());
  system_->ascend_in_order(force, over, executor());
}

std::vector<char> GlobalStep::over(std::span<const Index> ranks) const {
  return linear::supernodes_over(*system_->analysis(), ranks);
}

void GlobalStep::solve_alike(const linear::SparseMatrix& lower, std::span<Vec2> b) const {
  assert(held_.free.count == static_cast<Index>(b.size()));
  throw_if_cancelled(executor().stop());
  const auto other = linear::definite(linear::try_factor(system_->analysis(), lower, executor()));
  throw_if_cancelled(executor().stop());
  other->solve(b, executor());
  throw_if_cancelled(executor().stop());
}

}  // namespace unwrapd::solve::arap
