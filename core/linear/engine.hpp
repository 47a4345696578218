#pragma once
// Our own engine behind the interface of factor.hpp: a supernodal Cholesky factor, found by the
// multifrontal method.

#include <memory>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/analysis.hpp"
#include "core/linear/factor.hpp"
#include "core/linear/large_array.hpp"

namespace unwrapd::linear {

class Factor final : public RealSystem {
 public:
  /// A factor without numbers: refill() comes first.
  explicit Factor(std::shared_ptr<const Analysis> analysis);

  /// Factors the matrix, of the pattern analysed, in the memory of the one before. False when it is
  /// not positive definite in double precision: nothing may be solved then until the next one is.
  [[nodiscard]] bool refill(const SparseMatrix& lower, Executor& executor);
  [[nodiscard]] bool refill(const SparseMatrix& lower);

  /// The same bits for any executor. Thread-safe, but for an executor that is not.
  void solve(std::span<Vec2> b, Executor& executor) const;
  void solve(std::span<Vec2> b, const std::stop_token& stop = {}) const override;

  /// As solve(), of unknowns listed in the order of elimination (analysis()->nodes.order).
  void solve_in_order(std::span<Vec2> b, Executor& executor) const;

  /// The halves of solve_in_order(), one after the other; of those supernodes only that are among
  /// `over` (supernodes_over()), or of all where it is empty: see descend_panels().
  void descend_in_order(std::span<Vec2> b, std::span<const char> over, Executor& executor) const;
  void ascend_in_order(std::span<Vec2> b, std::span<const char> over, Executor& executor) const;

  [[nodiscard]] const std::shared_ptr<const Analysis>& analysis() const { return analysis_; }

  /// While it is refilled, its analysis included.
  [[nodiscard]] std::size_t job_bytes() const { return analysis_->job_bytes(); }

  /// That this takes, its analysis included.
  [[nodiscard]] std::size_t bytes() const { return analysis_->bytes() + analysis_->panel_bytes(); }

  /// One right-hand side of a matrix of pairs (analyse_pairs()): b[v] has the unknowns 2v, 2v + 1.
  /// Thread-safe. Throws Error{cancelled}.
  void solve_pairs(std::span<Vec2> b, const std::stop_token& stop = {}) const;

 private:
  std::shared_ptr<const Analysis> analysis_;
  LargeArray panels_;
};

/// Nothing when the matrix, of the pattern analysed, is not positive definite in double precision.
std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower, Executor& executor);
std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower);

}  // namespace unwrapd::linear
