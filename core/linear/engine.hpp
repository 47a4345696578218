#pragma once
// A supernodal Cholesky factor by the multifrontal method, behind the interface of factor.hpp.

#include <memory>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/analysis.hpp"
#include "core/linear/factor.hpp"
#include "core/linear/large_array.hpp"

namespace unwrapd::linear {

class Factor final : public RealSystem {
 public:
  /// A factor without numbers: call refill() first.
  explicit Factor(std::shared_ptr<const Analysis> analysis);

  /// Factors a matrix of the analysed pattern, in the memory of the previous factor. Returns false
  /// if it is not positive definite in double precision; then solve() must not be called until a
  /// refill succeeds.
  [[nodiscard]] bool refill(const SparseMatrix& lower, Executor& executor);
  [[nodiscard]] bool refill(const SparseMatrix& lower);

  /// The same bits for any executor. As thread-safe as the executor.
  void solve(std::span<Vec2> b, Executor& executor) const;
  void solve(std::span<Vec2> b, const std::stop_token& stop = {}) const override;

  /// As solve(), of unknowns listed in the order of elimination (analysis()->nodes.order).
  void solve_in_order(std::span<Vec2> b, Executor& executor) const;

  /// The two halves of solve_in_order(). They only visit the supernodes in `over`
  /// (supernodes_over()), or all if it is empty: see descend_panels().
  void descend_in_order(std::span<Vec2> b, std::span<const char> over, Executor& executor) const;
  void ascend_in_order(std::span<Vec2> b, std::span<const char> over, Executor& executor) const;

  [[nodiscard]] const std::shared_ptr<const Analysis>& analysis() const { return analysis_; }

  /// Bytes during a refill, analysis included.
  [[nodiscard]] std::size_t job_bytes() const { return analysis_->job_bytes(); }

  /// Bytes of the factor, analysis included.
  [[nodiscard]] std::size_t bytes() const { return analysis_->bytes() + analysis_->panel_bytes(); }

  /// One right-hand side of a matrix of pairs (analyse_pairs()): b[v] has the unknowns 2v, 2v + 1.
  /// Thread-safe. Throws Error{cancelled}.
  void solve_pairs(std::span<Vec2> b, const std::stop_token& stop = {}) const;

 private:
  std::shared_ptr<const Analysis> analysis_;
  LargeArray panels_;
};

/// Empty if the matrix, of the analysed pattern, is not positive definite in double precision.
std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower, Executor& executor);
std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower);

}  // namespace unwrapd::linear
