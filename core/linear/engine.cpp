// The multifrontal method (Duff, Reid, "The multifrontal solution of indefinite sparse symmetric
// linear equations", 1983; stack of updates in postorder: Liu, "The multifrontal method for sparse
// matrix solution", 1992). Each supernode gathers its entries of the matrix and the updates of its
// children in one dense front, factors its columns there and leaves the rest as its own update.
// Rejected: left-looking supernodes (CHOLMOD's), which gather from many small blocks.
#include "core/linear/engine.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "core/linear/front.hpp"

namespace unwrapd {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

PanelShape shape_of(const Supernodes& nodes, std::size_t s) {
  return {nodes.pivots(s), nodes.below(s).size()};
}

std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

/// The matrix's entries by new columns.
void list_entries(const SparseMatrix& lower, Analysis& analysis) {
  const std::vector<Index>& position = analysis.nodes.position;
  const auto for_each_entry = [&](auto visit) {
    for (Index j = 0; j < static_cast<Index>(lower.cols()); ++j)
      for (Index p = lower.outerIndexPtr()[j]; p < lower.outerIndexPtr()[j + 1]; ++p)
        visit(std::minmax(position[at(j)], position[at(lower.innerIndexPtr()[p])]), p);
  };
  analysis.entry_begin.assign(position.size() + 1, 0);
  for_each_entry(
      [&](std::pair<Index, Index> ends, Index) { ++analysis.entry_begin[at(ends.first) + 1]; });
  std::partial_sum(analysis.entry_begin.begin(), analysis.entry_begin.end(),
                   analysis.entry_begin.begin());
  analysis.entry_row.resize(at(analysis.entry_begin.back()));
  analysis.entry_source.resize(analysis.entry_row.size());
  std::vector<Index> next(analysis.entry_begin.begin(), analysis.entry_begin.end() - 1);
  for_each_entry([&](std::pair<Index, Index> ends, Index p) {
    const std::size_t to = at(next[at(ends.first)]++);
    analysis.entry_row[to] = ends.second;
    analysis.entry_source[to] = p;
  });
}

/// Updates pile up: a supernode takes those of its children off the pile and puts its own there.
std::size_t most_pending(const Supernodes& nodes) {
  std::vector<std::size_t> pile;
  std::size_t size = 0, most = 0;
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    for (Index c = 0; c < nodes.child_count[s]; ++c) size -= pile.back(), pile.pop_back();
    pile.push_back(packed_size(nodes.below(s).size()));
    size += pile.back();
    most = std::max(most, size);
  }
  return most;
}

class Factorisation {
 public:
  Factorisation(const Analysis& analysis, const double* values)
      : analysis_(analysis),
        nodes_(analysis.nodes),
        values_(values),
        local_row_(nodes_.order.size()),
        pile_(std::make_unique_for_overwrite<double[]>(analysis.pending_size)) {}

  /// False on a bad pivot.
  bool run(double* panels) {
    for (std::size_t s = 0; s < nodes_.count(); ++s) {
      front_.reset(shape_of(nodes_, s));
      number_rows(s);
      add_entries(s);
      for (Index c = 0; c < nodes_.child_count[s]; ++c) add_update();
      if (!front_.factor(panels + analysis_.panel_begin[s])) return false;
      keep_update(s);
    }
    return true;
  }

 private:
  void number_rows(std::size_t s) {
    Index local = 0;
    for (Index k = nodes_.first[s]; k < nodes_.first[s + 1]; ++k) local_row_[at(k)] = local++;
    local = static_cast<Index>(front_.update_begin());
    for (Index row : nodes_.below(s)) local_row_[at(row)] = local++;
  }

  void add_entries(std::size_t s) {
    for (Index k = nodes_.first[s]; k < nodes_.first[s + 1]; ++k) {
      const auto j = at(k - nodes_.first[s]);
      double* column = front_.diagonal(j) - j;
      for (Index p = analysis_.entry_begin[at(k)]; p < analysis_.entry_begin[at(k) + 1]; ++p)
        column[local_row_[at(analysis_.entry_row[at(p)])]] +=
            values_[analysis_.entry_source[at(p)]];
    }
  }

  /// Adds the update on top of the pile to the front.
  void add_update() {
    const std::span<const Index> rows = nodes_.below(pending_.back());
    pending_.pop_back();
    top_ -= packed_size(rows.size());
    rows_in_front_.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) rows_in_front_[i] = local_row_[at(rows[i])];
    const double* from = pile_.get() + top_;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const std::size_t column = at(rows_in_front_[j]);
      double* to = front_.diagonal(column) - column;
      for (std::size_t i = j; i < rows.size(); ++i) to[rows_in_front_[i]] += *from++;
    }
  }

  void keep_update(std::size_t s) {
    const std::size_t size = nodes_.below(s).size();
    double* to = pile_.get() + top_;
    for (std::size_t j = 0; j < size; ++j)
      to = std::copy_n(front_.diagonal(front_.update_begin() + j), size - j, to);
    top_ += packed_size(size);
    pending_.push_back(s);
  }

  const Analysis& analysis_;
  const Supernodes& nodes_;
  const double* values_;
  Front front_;
  std::vector<Index> local_row_;      ///< where in the front a row is
  std::vector<Index> rows_in_front_;  ///< of the update being added
  std::vector<std::size_t> pending_;  ///< the supernodes whose updates lie on the pile
  std::unique_ptr<double[]> pile_;
  std::size_t top_ = 0;
};

/// The vectors over one panel's rows, reused from panel to panel.
class Workspace {
 public:
  explicit Workspace(std::size_t height) : numbers_(4 * height) {
    const auto part = [&](std::size_t k) { return numbers_.data() + k * height; };
    tall_ = {part(0), part(1)};
    pivots_ = {part(2), part(3)};
  }

  [[nodiscard]] PanelVectors tall() const { return tall_; }
  [[nodiscard]] PanelVectors pivots() const { return pivots_; }

 private:
  std::vector<double> numbers_;
  PanelVectors tall_{}, pivots_{};
};

class MultifrontalSystem final : public RealSystem {
 public:
  explicit MultifrontalSystem(std::shared_ptr<const Analysis> analysis)
      : analysis_(std::move(analysis)),
        panels_(std::make_unique_for_overwrite<double[]>(analysis_->panel_begin.back())) {}

  [[nodiscard]] bool factor(const double* values) {
    return Factorisation(*analysis_, values).run(panels_.get());
  }

  void solve(std::span<Vec2> b) const override {
    const Supernodes& nodes = analysis_->nodes;
    assert(b.size() == nodes.order.size());
    std::vector<Vec2> x(b.size());
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = b[at(nodes.order[k])];
    const Workspace work(tallest());
    for (std::size_t s = 0; s < nodes.count(); ++s) forward(s, work, x);
    for (std::size_t s = nodes.count(); s-- > 0;) backward(s, work, x);
    for (std::size_t k = 0; k < x.size(); ++k) b[at(nodes.order[k])] = x[k];
  }

 private:
  [[nodiscard]] std::size_t tallest() const {
    std::size_t height = 0;
    for (std::size_t s = 0; s < analysis_->nodes.count(); ++s)
      height = std::max(height, shape_of(analysis_->nodes, s).height());
    return height;
  }

  [[nodiscard]] const double* panel(std::size_t s) const {
    return panels_.get() + analysis_->panel_begin[s];
  }

  /// y1 = L11^-1 b1; b2 -= L21 y1.
  void forward(std::size_t s, const Workspace& work, std::vector<Vec2>& x) const {
    const Supernodes& nodes = analysis_->nodes;
    const PanelShape shape = shape_of(nodes, s);
    const PanelVectors tall = work.tall(), pivots = work.pivots();
    Vec2* own = x.data() + nodes.first[s];
    for (std::size_t k = 0; k < shape.pivots; ++k)
      pivots.u[k] = own[k].x(), pivots.v[k] = own[k].y();
    std::fill_n(tall.u, shape.height(), 0.0);
    std::fill_n(tall.v, shape.height(), 0.0);
    multiply_panel(panel(s), shape, pivots, tall);
    for (std::size_t k = 0; k < shape.pivots; ++k) own[k] = {tall.u[k], tall.v[k]};
    std::size_t r = shape.pivots;
    for (Index row : nodes.below(s)) x[at(row)] -= Vec2(tall.u[r], tall.v[r]), ++r;
  }

  /// x1 = L11^-T (y1 - L21^T x2).
  void backward(std::size_t s, const Workspace& work, std::vector<Vec2>& x) const {
    const Supernodes& nodes = analysis_->nodes;
    const PanelShape shape = shape_of(nodes, s);
    const PanelVectors tall = work.tall(), pivots = work.pivots();
    Vec2* own = x.data() + nodes.first[s];
    for (std::size_t k = 0; k < shape.pivots; ++k) tall.u[k] = own[k].x(), tall.v[k] = own[k].y();
    std::size_t r = shape.pivots;
    for (Index row : nodes.below(s)) tall.u[r] = -x[at(row)].x(), tall.v[r] = -x[at(row)].y(), ++r;
    std::fill(tall.u + r, tall.u + shape.height(), 0.0);
    std::fill(tall.v + r, tall.v + shape.height(), 0.0);
    multiply_transposed(panel(s), shape, tall, pivots);
    for (std::size_t k = 0; k < shape.pivots; ++k) own[k] = {pivots.u[k], pivots.v[k]};
  }

  std::shared_ptr<const Analysis> analysis_;
  std::unique_ptr<double[]> panels_;
};

}  // namespace

std::shared_ptr<const Analysis> analyse(const SparseMatrix& lower) {
  assert(lower.isCompressed());
  const std::span begin(lower.outerIndexPtr(), static_cast<std::size_t>(lower.cols()) + 1);
  const std::span row(lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros()));
  Analysis analysis;
  analysis.nodes = analyse(graph_of_lower(begin, row));
  list_entries(lower, analysis);
  analysis.panel_begin.assign(1, 0);
  for (std::size_t s = 0; s < analysis.nodes.count(); ++s)
    analysis.panel_begin.push_back(analysis.panel_begin.back() +
                                   shape_of(analysis.nodes, s).size());
  analysis.pending_size = most_pending(analysis.nodes);
  return std::make_shared<const Analysis>(std::move(analysis));
}

std::unique_ptr<RealSystem> try_factor(std::shared_ptr<const Analysis> analysis,
                                       const SparseMatrix& lower) {
  assert(lower.isCompressed() && analysis->entry_row.size() == at(Index(lower.nonZeros())));
  auto system = std::make_unique<MultifrontalSystem>(std::move(analysis));
  if (!system->factor(lower.valuePtr())) return nullptr;
  return system;
}

}  // namespace unwrapd
