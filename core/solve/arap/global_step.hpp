#pragma once
// The global step: all fitted triangles are stitched together by one linear solve (Sec. 4.4.2).

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

/// How vertices are held, wherever that is: all that the matrix reads of Holds.
struct ConstraintPattern {
  linear::FreeVertices free;
  std::vector<Index> soft_constraint;  ///< vertices, and the weights of their soft constraints
  std::vector<double> weight;

  ConstraintPattern(std::size_t vertex_count, const VertexConstraints& constraints);
  [[nodiscard]] bool is_empty() const;
};
void describe(CacheKey& key, const ConstraintPattern& constrained);

/// The matrix of Eq. (4), factored once: the Hessian of Objective for fixed fits. It depends on the
/// mesh, on which vertices are held and on the soft constraints' weights, not on where they are
/// held: jobs that share disk.core share it, and jobs on meshes of the same faces its analysis.
class GlobalStep {
 public:
  /// executor: runs the factor and all solves; null: the calling thread. Throws
  /// Error{solver_failed, too_much_memory}.
  GlobalStep(const Disk& disk, const VertexConstraints& constraints, Executor* executor = nullptr);

  /// What runs its solves.
  [[nodiscard]] Executor& executor() const { return executor_ != nullptr ? *executor_ : serial_; }

  /// Replaces force (Objective::evaluate()) by the change of the map A^-1 force; fixed vertices do
  /// not move. Solving for the change, not for the map, keeps full precision near convergence.
  /// The same for any executor. Thread-safe where its executor is.
  void solve(std::span<Vec2> force) const;

  /// In which order vertices are eliminated: rank[v] of vertex v, fixed ones last. What lies side
  /// by side in it lies near by on the disk, too.
  [[nodiscard]] std::span<const Index> rank() const { return rank_; }

  /// As solve(), of a force listed by ranks, which saves sorting it.
  void solve_by_rank(std::span<Vec2> force) const;

  /// The two halves of solve_by_rank() where nothing is held: after the first, forces on vertices
  /// among those that `over` was made for may be added up with those of another first half. Only
  /// what lies over them is read: the change elsewhere is not found. over: empty for all vertices.
  void descend_by_rank(std::span<Vec2> force, std::span<const char> over) const;
  void ascend_by_rank(std::span<Vec2> force, std::span<const char> over) const;

  /// For these vertices, given by ranks.
  [[nodiscard]] std::vector<char> over(std::span<const Index> ranks) const;

  /// Replaces b by the solution for another positive definite matrix of the same pattern, of which
  /// the lower triangle is given; nothing is held. Throws Error{solver_failed}.
  void solve_alike(const linear::SparseMatrix& lower, std::span<Vec2> b) const;

  /// What it was made of; nothing where nothing is shared.
  [[nodiscard]] const std::optional<Digest>& made_of() const { return made_of_; }

 private:
  ConstraintPattern held_;
  std::optional<Digest> made_of_;
  std::shared_ptr<const linear::Factor> system_;  // null where no vertex is free
  std::vector<Index> rank_;
  Executor* executor_;
  mutable SerialExecutor serial_;
};

/// All but what runs it.
void describe(CacheKey& key, const GlobalStep& global);

/// One entry a vertex, listed by ranks; and back.
std::vector<Vec2> by_rank(std::span<const Vec2> by_vertex, std::span<const Index> rank);
std::vector<Vec2> by_vertex(std::span<const Vec2> by_rank, std::span<const Index> rank);

}  // namespace unwrapd::solve::arap
