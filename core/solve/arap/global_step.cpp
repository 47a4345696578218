// Eq. (4): sum_j [cot + cot](u_i - u_j) = sum_j [cot L + cot L](x_i - x_j) for every vertex i.
// The matrix is a sum of positive semidefinite element matrices whatever the cotangents' signs; its
// only null space is translation. Fixed vertices are eliminated and springs add to the diagonal:
// either removes that null space. Where nothing is held, adding the diagonal entry of vertex 0 once
// more does, and leaves the solution exact, because the right-hand side adds up to zero.
#include "core/solve/arap/global_step.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/linear/solve_panels.hpp"
#include "core/solve/base/kept.hpp"

namespace unwrapd {
namespace {

SparseMatrix held_matrix(const Disk& disk, const HeldPattern& held, Executor& executor) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const RestTriangle& rest : disk.rest)
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  throw_if_cancelled(disk.stop);
  SparseMatrix lower = lower_laplacian(disk.faces, disk.vertex_count(), weight, executor);
  for (std::size_t k = 0; k < held.spring.size(); ++k)
    lower.coeffRef(held.spring[k], held.spring[k]) += 2 * held.weight[k];
  if (held.is_empty()) lower.coeffRef(0, 0) *= 2;
  return lower;
}

SparseMatrix free_matrix(const Disk& disk, const HeldPattern& held, Executor& executor) {
  SparseMatrix lower = held_matrix(disk, held, executor);
  const std::size_t count = held.free.slot.size();
  if (static_cast<std::size_t>(held.free.count) == count) return lower;
  const std::vector<Vec2> nowhere(count, Vec2::Zero());  // only the matrix is wanted
  return eliminate<SparseMatrix, Vec2>(lower, held.free, nowhere, disk.stop).lower;
}

std::shared_ptr<const Analysis> analysed(const Making& by, const SparsePattern& lower,
                                         bool is_ordered) {
  return is_ordered ? analyse_in_order(lower, by.stop) : analyse(lower, by.stop);
}

std::shared_ptr<const Factor> factored(const Making& by, const Disk& disk,
                                       const HeldPattern& held) {
  const SparseMatrix lower = free_matrix(disk, held, *by.executor);
  throw_if_cancelled(by.executor->stop());
  const auto analysis = kept<analysed>(by, SparsePattern(lower), disk.is_ordered);
  throw_if_cancelled(by.executor->stop());
  check_memory(disk, analysis->job_bytes());
  return definite(try_factor(analysis, lower, *by.executor));
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

HeldPattern::HeldPattern(std::size_t vertex_count, const Holds& holds)
    : free(free_vertices(vertex_count, holds)) {
  for (const Spring& s : holds.springs) spring.push_back(s.vertex), weight.push_back(s.weight);
}

bool HeldPattern::is_empty() const {
  return static_cast<std::size_t>(free.count) == free.slot.size() && spring.empty();
}

void describe(Fingerprint& key, const HeldPattern& held) {
  const auto& [free, spring, weight] = held;
  key.add(free.slot).add(spring).add(weight);
}

void describe(Fingerprint& key, const GlobalStep& global) { key.add(global.made_of()); }

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
    : held_(disk.positions.size(), holds), executor_(executor) {
  if (disk.core != nullptr) made_of_ = key_of<factored>(*disk.core, disk, held_);
  if (held_.free.count == 0) {
    rank_ = ranks(held_.free, {});
    return;
  }
  system_ = kept<factored>(Making{disk.core, disk.stop, &this->executor()}, disk, held_);
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
  return supernodes_over(*system_->analysis(), ranks);
}

void GlobalStep::solve_alike(const SparseMatrix& lower, std::span<Vec2> b) const {
  assert(held_.free.count == static_cast<Index>(b.size()));
  throw_if_cancelled(executor().stop());
  const auto other = definite(try_factor(system_->analysis(), lower, executor()));
  throw_if_cancelled(executor().stop());
  other->solve(b, executor());
  throw_if_cancelled(executor().stop());
}

}  // namespace unwrapd
