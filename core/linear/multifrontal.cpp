// The multifrontal method (Duff, Reid, "The multifrontal solution of indefinite sparse symmetric
// linear equations", 1983; stack of updates in postorder: Liu, "The multifrontal method for sparse
// matrix solution", 1992). Each supernode gathers its entries of the matrix and the updates of its
// children in one dense front, factors its columns there and leaves the rest as its own update.
// Rejected: left-looking supernodes (CHOLMOD's), which gather from many small blocks.
#include "core/linear/multifrontal.hpp"

#include <algorithm>
#include <new>

#include "core/base/cancel.hpp"
#include "core/linear/front.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {

/// The update that a supernode passes to its parent.
struct Update {
  std::size_t supernode;
  const double* numbers;
  bool is_on_pile;  ///< whether it is on the stack of this factorization
};

class Factorisation {
 public:
  Factorisation(const Analysis& analysis, const double* values, double* panels)
      : analysis_(analysis),
        nodes_(analysis.nodes),
        values_(values),
        panels_(panels),
        local_row_(std::make_unique_for_overwrite<Index[]>(nodes_.order.size())) {}

  /// Reserves memory for the updates that wait at any time.
  void reserve(std::size_t numbers) { pile_ = large_array(numbers); }

  /// False on a bad pivot.
  [[nodiscard]] bool eliminate(std::size_t s, Executor& executor) {
    front_.reset(analysis_.shape(s));
    number_rows(s);
    add_entries(s);
    for (Index c = 0; c < nodes_.child_count[s]; ++c) add_update();
    if (!front_.factor(panels_ + analysis_.panel_begin[s], executor)) return false;
    keep_update(s);
    return true;
  }

  /// Takes the update of supernode s, which was eliminated elsewhere.
  void take(std::size_t s, const double* update) { pending_.push_back({s, update, false}); }

  /// A copy of the last supernode's update.
  [[nodiscard]] std::vector<double> leave() const {
    const double* const end = pile_.get() + top_;
    return {pending_.back().numbers, end};
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

  /// Adds the top update of the stack to the front.
  void add_update() {
    const Update update = pending_.back();
    const std::span<const Index> rows = nodes_.below(update.supernode);
    pending_.pop_back();
    if (update.is_on_pile) top_ -= packed_size(rows.size());
    rows_in_front_.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) rows_in_front_[i] = local_row_[at(rows[i])];
    const double* from = update.numbers;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const std::size_t column = at(rows_in_front_[j]);
      double* to = front_.diagonal(column) - column;
      for (std::size_t i = j; i < rows.size(); ++i) to[rows_in_front_[i]] += *from++;
    }
  }

  void keep_update(std::size_t s) {
    const std::size_t size = nodes_.below(s).size();
    double* to = pile_.get() + top_;
    pending_.push_back({s, to, true});
    for (std::size_t j = 0; j < size; ++j)
      to = std::copy_n(front_.diagonal(front_.update_begin() + j), size - j, to);
    top_ += packed_size(size);
  }

  const Analysis& analysis_;
  const Supernodes& nodes_;
  const double* values_;
  double* panels_;
  Front front_;
  std::unique_ptr<Index[]> local_row_;  ///< position of each row in the front
  std::vector<Index> rows_in_front_;    ///< of the update that is being added
  std::vector<Update> pending_;         ///< in the order in which parents take them, last first
  LargeArray pile_;
  std::size_t top_ = 0;
};

/// The result of a separately factored subtree: the update of its root.
struct BranchUpdate {
  std::vector<double> update;
  bool is_definite = false;
  bool has_memory = true;
};

class Tree {
 public:
  Tree(const Analysis& analysis, const double* values, double* panels)
      : analysis_(analysis), values_(values), panels_(panels) {}

  bool factor(Executor& executor) {
    const std::vector<Branch>& all = analysis_.branches.all;
    grown_.resize(all.size());
    executor.for_each_block(static_cast<int>(all.size()),
                            [&](int b) { grow(all[at(b)], executor.stop(), grown_[at(b)]); });
    throw_if_cancelled(executor.stop());
    for (const BranchUpdate& grown : grown_)
      if (!grown.has_memory) throw std::bad_alloc();
    return std::ranges::all_of(grown_, &BranchUpdate::is_definite) && factor_trunk(executor);
  }

 private:
  void grow(const Branch& branch, const std::stop_token& stop, BranchUpdate& grown) const try {
    Factorisation work(analysis_, values_, panels_);
    work.reserve(most_pending(analysis_.nodes, branch));
    SerialExecutor serial;
    for (std::size_t s = branch.first; s < branch.end; ++s)
      if (is_cancelled(stop) || !work.eliminate(s, serial)) return;
    grown.update = work.leave();
    grown.is_definite = true;
  } catch (const std::bad_alloc&) {  // tasks must not throw
    grown.has_memory = false;
  }

  bool factor_trunk(Executor& executor) {
    Factorisation work(analysis_, values_, panels_);
    work.reserve(analysis_.pending_size);
    bool is_definite = true;
    analysis_.branches.for_each_of_trunk(
        analysis_.nodes.count(),
        [&](std::size_t s) {
          throw_if_cancelled(executor.stop());
          is_definite = is_definite && work.eliminate(s, executor);
        },
        [&](std::size_t b) {
          work.take(analysis_.branches.all[b].root(), grown_[b].update.data());
        });
    return is_definite;
  }

  const Analysis& analysis_;
  const double* values_;
  double* panels_;
  std::vector<BranchUpdate> grown_;
};

}  // namespace

bool factor_multifrontal(const Analysis& analysis, const double* values, double* panels,
                         Executor& executor) {
  return Tree(analysis, values, panels).factor(executor);
}

}  // namespace unwrapd::linear
