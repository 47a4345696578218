// A solve reads all panels twice, in the order in which they lie: once down the columns, once up.
#include "core/linear/engine.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/linear/multifrontal.hpp"

namespace unwrapd {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

/// The vectors over one panel's rows, reused from panel to panel.
struct Factor::Workspace {
  explicit Workspace(std::size_t height) : numbers(4 * height) {
    const auto part = [&](std::size_t k) { return numbers.data() + k * height; };
    tall = {part(0), part(1)};
    pivots = {part(2), part(3)};
  }

  std::vector<double> numbers;
  PanelVectors tall{}, pivots{};
};

Factor::Factor(std::shared_ptr<const Analysis> analysis)
    : analysis_(std::move(analysis)),
      panels_(std::make_unique_for_overwrite<double[]>(analysis_->panel_begin.back())) {}

bool Factor::refill(const SparseMatrix& lower) {
  assert(lower.isCompressed() && analysis_->entry_row.size() == at(Index(lower.nonZeros())));
  return factor_multifrontal(*analysis_, lower.valuePtr(), panels_.get());
}

void Factor::solve(std::span<Vec2> b) const {
  const Supernodes& nodes = analysis_->nodes;
  assert(b.size() == nodes.order.size());
  std::vector<Vec2> x(b.size());
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = b[at(nodes.order[k])];
  const Workspace work(tallest());
  for (std::size_t s = 0; s < nodes.count(); ++s) forward(s, work, x);
  for (std::size_t s = nodes.count(); s-- > 0;) backward(s, work, x);
  for (std::size_t k = 0; k < x.size(); ++k) b[at(nodes.order[k])] = x[k];
}

void Factor::solve_pairs(std::span<Vec2> b) const {
  std::vector<Vec2> x;
  x.reserve(2 * b.size());
  for (const Vec2& pair : b) x.emplace_back(pair.x(), 0), x.emplace_back(pair.y(), 0);
  solve(x);
  for (std::size_t v = 0; v < b.size(); ++v) b[v] = {x[2 * v].x(), x[2 * v + 1].x()};
}

std::size_t Factor::tallest() const {
  std::size_t height = 0;
  for (std::size_t s = 0; s < analysis_->nodes.count(); ++s)
    height = std::max(height, analysis_->shape(s).height());
  return height;
}

const double* Factor::panel(std::size_t s) const {
  return panels_.get() + analysis_->panel_begin[s];
}

/// y1 = L11^-1 b1; b2 -= L21 y1.
void Factor::forward(std::size_t s, const Workspace& work, std::span<Vec2> x) const {
  const Supernodes& nodes = analysis_->nodes;
  const PanelShape shape = analysis_->shape(s);
  const PanelVectors tall = work.tall, pivots = work.pivots;
  Vec2* own = x.data() + nodes.first[s];
  for (std::size_t k = 0; k < shape.pivots; ++k) pivots.u[k] = own[k].x(), pivots.v[k] = own[k].y();
  std::fill_n(tall.u, shape.height(), 0.0);
  std::fill_n(tall.v, shape.height(), 0.0);
  multiply_panel(panel(s), shape, pivots, tall);
  for (std::size_t k = 0; k < shape.pivots; ++k) own[k] = {tall.u[k], tall.v[k]};
  std::size_t r = shape.pivots;
  for (Index row : nodes.below(s)) x[at(row)] -= Vec2(tall.u[r], tall.v[r]), ++r;
}

/// x1 = L11^-T (y1 - L21^T x2).
void Factor::backward(std::size_t s, const Workspace& work, std::span<Vec2> x) const {
  const Supernodes& nodes = analysis_->nodes;
  const PanelShape shape = analysis_->shape(s);
  const PanelVectors tall = work.tall, pivots = work.pivots;
  Vec2* own = x.data() + nodes.first[s];
  for (std::size_t k = 0; k < shape.pivots; ++k) tall.u[k] = own[k].x(), tall.v[k] = own[k].y();
  std::size_t r = shape.pivots;
  for (Index row : nodes.below(s)) tall.u[r] = -x[at(row)].x(), tall.v[r] = -x[at(row)].y(), ++r;
  std::fill(tall.u + r, tall.u + shape.height(), 0.0);
  std::fill(tall.v + r, tall.v + shape.height(), 0.0);
  multiply_transposed(panel(s), shape, tall, pivots);
  for (std::size_t k = 0; k < shape.pivots; ++k) own[k] = {pivots.u[k], pivots.v[k]};
}

std::unique_ptr<Factor> try_factor(std::shared_ptr<const Analysis> analysis,
                                   const SparseMatrix& lower) {
  auto system = std::make_unique<Factor>(std::move(analysis));
  if (!system->refill(lower)) return nullptr;
  return system;
}

}  // namespace unwrapd
