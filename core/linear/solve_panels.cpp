// All panels are read twice, in memory order: once in the forward sweep, once in the backward
// sweep. Branches run in parallel. In the forward sweep, the contributions of a branch to columns
// above it stay separate until all branches are done. In the backward sweep they only read those
// columns.
#include "core/linear/solve_panels.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {

/// Both right-hand sides over one panel's rows; its memory is reused for each panel.
class Workspace {
 public:
  explicit Workspace(std::size_t height) : rows_(2 * height) {}

  [[nodiscard]] PanelRows rows() { return rows_.data(); }
  [[nodiscard]] Vec2 row(std::size_t r) const {
    return {rows_[row_entry(r)], rows_[row_entry(r) + kDuo]};
  }
  void set_row(std::size_t r, const Vec2& x) {
    rows_[row_entry(r)] = x.x();
    rows_[row_entry(r) + kDuo] = x.y();
  }

 private:
  std::vector<double> rows_;
};

class Sweep {
 public:
  Sweep(const Analysis& analysis, const double* panels, std::span<Vec2> x,
        std::span<const char> over)
      : analysis_(analysis), nodes_(analysis.nodes), panels_(panels), x_(x), over_(over) {}

  void down(Executor& executor) {
    const Branches& branches = analysis_.branches;
    const std::size_t shared = branches.shared_count;
    sums_.assign(branches.all.size() * shared, Vec2::Zero());
    executor.for_each_block(static_cast<int>(branches.all.size()),
                            [&](int b) { down_branch(at(b), sums_.data() + at(b) * shared); });
    down_trunk(executor.stop());
  }

  void up(Executor& executor) const {
    up_trunk(executor.stop());
    executor.for_each_block(static_cast<int>(analysis_.branches.all.size()),
                            [&](int b) { up_branch(at(b)); });
  }

 private:
  [[nodiscard]] bool is_visited(std::size_t s) const { return over_.empty() || over_[s] != 0; }

  [[nodiscard]] Workspace workspace(Branch branch) const {
    std::size_t height = 0;
    for (std::size_t s = branch.first; s < branch.end; ++s)
      height = std::max(height, analysis_.shape(s).height());
    return Workspace(height);
  }

  void down_branch(std::size_t b, Vec2* sums) const {
    const Branch branch = analysis_.branches.all[b];
    Workspace work = workspace(branch);
    const Index end = nodes_.first[branch.end];
    for (std::size_t s = branch.first; s < branch.end; ++s) {
      if (!is_visited(s)) continue;
      eliminate(s, work);
      const std::span<const Index> rows = nodes_.below(s);
      const auto outer = std::lower_bound(rows.begin(), rows.end(), end);
      const auto own = static_cast<std::size_t>(outer - rows.begin());
      subtract(rows.first(own), work, analysis_.shape(s).pivots);
      for (std::size_t i = own, r = analysis_.shape(s).pivots + own; i < rows.size(); ++i, ++r)
        sums[analysis_.branches.shared[at(rows[i])]] += work.row(r);
    }
  }

  void down_trunk(const std::stop_token& stop) const {
    const Branches& branches = analysis_.branches;
    for (std::size_t b = 0; b < branches.all.size(); ++b)
      for (Index row : nodes_.below(branches.all[b].root()))
        x_[at(row)] -= sums_[b * branches.shared_count + at(branches.shared[at(row)])];
    Workspace work = workspace({0, nodes_.count()});
    branches.for_each_of_trunk(
        nodes_.count(),
        [&](std::size_t s) {
          throw_if_cancelled(stop);
          if (!is_visited(s)) return;
          eliminate(s, work);
          subtract(nodes_.below(s), work, analysis_.shape(s).pivots);
        },
        [](std::size_t) {});
  }

  void up_trunk(const std::stop_token& stop) const {
    Workspace work = workspace({0, nodes_.count()});
    const std::vector<Branch>& all = analysis_.branches.all;
    std::size_t end = nodes_.count();
    for (std::size_t b = all.size() + 1; b-- > 0;) {
      const std::size_t first = b > 0 ? all[b - 1].end : 0;
      for (std::size_t s = end; s-- > first;) {
        throw_if_cancelled(stop);
        if (is_visited(s)) substitute(s, work);
      }
      if (b > 0) end = all[b - 1].first;
    }
  }

  void up_branch(std::size_t b) const {
    const Branch branch = analysis_.branches.all[b];
    Workspace work = workspace(branch);
    for (std::size_t s = branch.end; s-- > branch.first;)
      if (is_visited(s)) substitute(s, work);
  }

  /// y1 = L11^-1 b1; work then has L21 y1 below the pivots.
  void eliminate(std::size_t s, Workspace& work) const {
    const PanelShape shape = analysis_.shape(s);
    Vec2* own = x_.data() + nodes_.first[s];
    kernels_.multiply(panels_ + analysis_.panel_begin[s], shape, own, work.rows());
    for (std::size_t k = 0; k < shape.pivots; ++k) own[k] = work.row(k);
  }

  /// b2 -= L21 y1
  void subtract(std::span<const Index> rows, const Workspace& work, std::size_t r) const {
    for (Index row : rows) x_[at(row)] -= work.row(r++);
  }

  /// x1 = L11^-T (y1 - L21^T x2).
  void substitute(std::size_t s, Workspace& work) const {
    const PanelShape shape = analysis_.shape(s);
    Vec2* own = x_.data() + nodes_.first[s];
    for (std::size_t k = 0; k < shape.pivots; ++k) work.set_row(k, own[k]);
    std::size_t r = shape.pivots;
    for (Index row : nodes_.below(s)) work.set_row(r++, -x_[at(row)]);
    if (r < shape.height()) work.set_row(r, Vec2::Zero());
    kernels_.multiply_transposed(panels_ + analysis_.panel_begin[s], shape, work.rows(), own);
  }

  const Analysis& analysis_;
  const Supernodes& nodes_;
  const double* panels_;
  const PanelKernels kernels_ = panel_kernels();
  std::span<Vec2> x_;
  std::span<const char> over_;  ///< the supernodes to visit; empty: all
  std::vector<Vec2> sums_;      ///< of each branch: its contributions to the columns above
};

}  // namespace

std::vector<char> supernodes_over(const Analysis& analysis, std::span<const Index> columns) {
  const Supernodes& nodes = analysis.nodes;
  std::vector<char> over(nodes.count(), 0);
  const auto owner = [&](Index column) -> char& {
    const auto next = std::upper_bound(nodes.first.begin(), nodes.first.end(), column);
    return over[static_cast<std::size_t>(next - nodes.first.begin()) - 1];
  };
  for (const Index column : columns) owner(column) = 1;
  for (std::size_t s = 0; s < over.size(); ++s)
    if (over[s] != 0 && !nodes.below(s).empty()) owner(nodes.below(s).front()) = 1;
  return over;
}

void descend_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                    std::span<const char> over, Executor& executor) {
  Sweep(analysis, panels, x, over).down(executor);
}

void ascend_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                   std::span<const char> over, Executor& executor) {
  Sweep(analysis, panels, x, over).up(executor);
}

void solve_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                  Executor& executor) {
  descend_panels(analysis, panels, x, {}, executor);
  ascend_panels(analysis, panels, x, {}, executor);
}

}  // namespace unwrapd::linear
