#include "core/linear/engine.hpp"

#include <cassert>
#include <utility>

#include "core/linear/multifrontal.hpp"
#include "core/linear/solve_panels.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {}  // namespace

Factor::Factor(std::shared_ptr<const Analysis> analysis)
    : analysis_(std::move(analysis)), panels_(large_array(analysis_->panel_begin.back())) {}

bool Factor::refill(const SparseMatrix& lower, Executor& executor) {
  assert(lower.isCompressed() && analysis_->entry_row.size() == at(Index(lower.nonZeros())));
  return factor_multifrontal(*analysis_, lower.valuePtr(), panels_.get(), executor);
}

bool Factor::refill(const SparseMatrix& lower) {
  SerialExecutor serial;
  return refill(lower, serial);
}

void Factor::solve(std::span<Vec2> b, Executor& executor) const {
  const std::vector<Index>& order = analysis_->nodes.order;
  assert(b.size() == order.size());
  std::vector<Vec2> x(b.size());
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = b[at(order[k])];
  solve_in_order(x, executor);
  for (std::size_t k = 0; k < x.size(); ++k) b[at(order[k])] = x[k];
}

void Factor::solve_in_order(std::span<Vec2> b, Executor& executor) const {
  solve_panels(*analysis_, panels_.get(), b, executor);
}

void Factor::descend_in_order(std::span<Vec2> b, std::span<const char> over,
                              Executor& executor) const {
  descend_panels(*analysis_, panels_.get(), b, over, executor);
}

void Factor::ascend_in_order(std::span<Vec2> b, std::span<const char> over,
                             Executor& executor) const {
  ascend_panels(*analysis_, panels_.get(), b, over, executor);
}

void Factor::solve(std::span<Vec2> b, const std::stop_token& stop) const {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  solve(b, job);
}

void Factor::solve_pairs(std::span<Vec2> b, const std::stop_token& stop) const {
  std::vector<Vec2> x;
  x.reserve(2 * b.size());
  for (const Vec2& pair : b) x.emplace_back(pair.x(), 0), x.emplace_back(pair.y(), 0);
  solve(x, stop);
  for (std::size_t v = 0; v < b.size(); ++v) b[v] = {x[2 * v].x(), x[2 * v + 1].x()};
}

std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower, Executor& executor) {
  auto system = std::make_unique<Factor>(std::move(analysis));
  if (!system->refill(lower, executor)) return nullptr;
  return system;
}

std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower) {
  SerialExecutor serial;
  return try_factor(std::move(analysis), lower, serial);
}

}  // namespace unwrapd::linear
