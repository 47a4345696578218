// The multifrontal method (Duff, Reid, "The multifrontal solution of indefinite sparse symmetric
// linear equations", 1983; stack of updates in postorder: Liu, "The multifrontal method for sparse
// matrix solution", 1992). Each supernode gathers its entries of the matrix and the updates of its
// children in one dense front, factors its columns there and leaves the rest as its own update.
// Rejected: left-looking supernodes (CHOLMOD's), which gather from many small blocks.
#include "core/linear/multifrontal.hpp"

#include <algorithm>

#include "core/linear/front.hpp"

namespace unwrapd {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

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
      front_.reset(analysis_.shape(s));
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

}  // namespace

bool factor_multifrontal(const Analysis& analysis, const double* values, double* panels) {
  return Factorisation(analysis, values).run(panels);
}

}  // namespace unwrapd
