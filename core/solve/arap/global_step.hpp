#pragma once
// The global step: one linear solve joins all fitted triangles (Sec. 4.4.2).

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/eliminate.hpp"
#include "core/linear/engine.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve::arap {

/// Which vertices are constrained, without positions: all that the matrix reads of
/// VertexConstraints.
struct ConstraintPattern {
  linear::FreeVertices free;
  std::vector<Index> soft_constraint;  ///< vertices, and the weights of their soft constraints
  std::vector<double> weight;

  ConstraintPattern(std::size_t vertex_count, const VertexConstraints& constraints);
  [[nodiscard]] bool is_empty() const;
};
void describe(CacheKey& key, const ConstraintPattern& constrained);

/// The matrix of Eq. (4), factored once: the Hessian of Objective for fixed fits. It depends on the
/// mesh, on which vertices are constrained and on the soft constraints' weights, not on positions
/// of constraints. Jobs that share disk.core share it; jobs on meshes of the same faces share its
/// analysis.
class GlobalStep {
 public:
  /// executor: runs the factor and all solves; null: the calling thread. Throws
  /// Error{solver_failed, too_much_memory}.
  GlobalStep(const Disk& disk, const VertexConstraints& constraints, Executor* executor = nullptr);

  /// The executor of its solves.
  [[nodiscard]] Executor& executor() const { return executor_ != nullptr ? *executor_ : serial_; }

  /// Replaces force (Objective::evaluate()) by the change of the map A^-1 force; fixed vertices do
  /// not move. Solving for the change, not for the map, keeps full precision near convergence. The
  /// same for any executor. As thread-safe as its executor.
  void solve(std::span<Vec2> force) const;

  /// The order of elimination: rank[v] of vertex v, fixed ones last. Vertices of near ranks lie
  /// near each other on the disk.
  [[nodiscard]] std::span<const Index> rank() const { return rank_; }

  /// As solve(), of a force listed by ranks, which saves sorting it.
  void solve_by_rank(std::span<Vec2> force) const;

  /// The two halves of solve_by_rank(), without constraints. After the first half, forces on
  /// vertices of the set that `over` was made for may be added to those of another first half. The
  /// second half only computes the change at these vertices. over: empty for all vertices.
  void descend_by_rank(std::span<Vec2> force, std::span<const char> over) const;
  void ascend_by_rank(std::span<Vec2> force, std::span<const char> over) const;

  /// The set `over` of these vertices, given by ranks.
  [[nodiscard]] std::vector<char> over(std::span<const Index> ranks) const;

  /// Replaces b by the solution for another positive definite matrix of the same pattern. lower:
  /// its lower triangle. There are no constraints. Throws Error{solver_failed}.
  void solve_alike(const linear::SparseMatrix& lower, std::span<Vec2> b) const;

  /// The digest of its inputs; empty if nothing is shared.
  [[nodiscard]] const std::optional<Digest>& made_of() const { return made_of_; }

 private:
  ConstraintPattern held_;
  std::optional<Digest> made_of_;
  std::shared_ptr<const linear::Factor> system_;  // null if no vertex is free
  std::vector<Index> rank_;
  Executor* executor_;
  mutable SerialExecutor serial_;
};

/// Describes all of it except the executor.
void describe(CacheKey& key, const GlobalStep& global);

/// Reorders one entry a vertex into rank order, and back.
std::vector<Vec2> by_rank(std::span<const Vec2> by_vertex, std::span<const Index> rank);
std::vector<Vec2> by_vertex(std::span<const Vec2> by_rank, std::span<const Index> rank);

}  // namespace unwrapd::solve::arap
