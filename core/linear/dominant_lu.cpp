// Multifrontal LU over the order and the supernodes of a Cholesky factor: with a symmetric pattern,
// row k of U and column k of L have the pattern of its column k. A front is a full square here, the
// pivots first, with the right-hand side as two more columns. The elimination turns these into L^-1
// b, so that L is not stored and only one backward sweep remains. Rejected: row after row along the
// elimination tree's reach, entry by entry (four times slower); Eigen's SparseLU, which orders and
// stores for partial pivoting (docs/adr/0009).
#include "core/linear/dominant_lu.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/linear/sparse.hpp"
#include "core/linear/supernodal.hpp"

namespace unwrapd::linear {
namespace {

constexpr std::size_t kRhs = 2;      // columns of a right-hand side
constexpr std::size_t kAbreast = 4;  // pivots that are subtracted from other rows at once

Graph graph_of(const SparseMatrix& matrix) {
  std::vector<Index> begin{0}, row;
  for (Index j = 0; j < static_cast<Index>(matrix.cols()); ++j) {
    for (SparseMatrix::InnerIterator it(matrix, j); it; ++it)
      if (it.row() >= j) row.push_back(static_cast<Index>(it.row()));
    begin.push_back(static_cast<Index>(row.size()));
  }
  return graph_of_lower(begin, row);
}

/// Rows one after the other: `pivots` to eliminate, then those passed to the parent.
struct SquareFront {
  double* numbers;
  std::size_t pivots, size, stride;

  [[nodiscard]] double* row(std::size_t i) const { return numbers + i * stride; }
};

/// Subtracts `count` pivots from k on from row i.
[[gnu::always_inline]] inline void reduce_row(const SquareFront& front, std::size_t k,
                                              std::size_t count, std::size_t i) {
  double* own = front.row(i);
  double weight[kAbreast] = {};
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t q = 0; q < p; ++q) own[k + p] -= weight[q] * front.row(k + q)[k + p];
    weight[p] = own[k + p] / front.row(k + p)[k + p];
  }
  const double* of[kAbreast];
  for (std::size_t p = 0; p < kAbreast; ++p) of[p] = front.row(k + std::min(p, count - 1));
  for (std::size_t j = k + count; j < front.stride; ++j)
    own[j] -= (weight[0] * of[0][j] + weight[1] * of[1][j]) +
              (weight[2] * of[2][j] + weight[3] * of[3][j]);
}

[[gnu::always_inline]] inline bool reduce_front(const SquareFront& front) {
  for (std::size_t k = 0; k < front.pivots; k += kAbreast) {
    const std::size_t count = std::min(kAbreast, front.pivots - k);
    for (std::size_t p = 0; p < count; ++p) {
      if (p > 0) reduce_row(front, k, p, k + p);
      const double pivot = std::abs(front.row(k + p)[k + p]);
      if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    }
    for (std::size_t i = k + count; i < front.size; ++i) reduce_row(front, k, count, i);
  }
  return true;
}

bool reduce_on_baseline(const SquareFront& front) { return reduce_front(front); }

[[gnu::target("avx2")]] bool reduce_avx2(const SquareFront& front) { return reduce_front(front); }

/// Eliminates the pivots of a front; false if one vanishes.
using Reduce = bool (*)(const SquareFront& front);

/// An entry of the matrix, by positions in the order of elimination.
struct Entry {
  Index row, column;
  double value;
};

/// Sorted by the first of their two positions.
std::vector<Entry> sorted_entries(const SparseMatrix& matrix, std::span<const Index> position,
                                  std::vector<std::size_t>& begin) {
  begin.assign(position.size() + 1, 0);
  const auto for_each_entry = [&](auto visit) {
    for (Index j = 0; j < static_cast<Index>(matrix.cols()); ++j)
      for (SparseMatrix::InnerIterator it(matrix, j); it; ++it) {
        const Entry entry{position[at(static_cast<Index>(it.row()))], position[at(j)], it.value()};
        visit(at(std::min(entry.row, entry.column)), entry);
      }
  };
  for_each_entry([&](std::size_t k, const Entry&) { ++begin[k + 1]; });
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<Entry> entries(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for_each_entry([&](std::size_t k, const Entry& entry) { entries[next[k]++] = entry; });
  return entries;
}

class DominantLu {
 public:
  DominantLu(const SparseMatrix& matrix, const Supernodes& nodes, Reduce reduce)
      : nodes_(nodes),
        reduce_(reduce),
        entries_(sorted_entries(matrix, nodes.position, entry_begin_)),
        local_(nodes.order.size()) {}

  /// Solves in place: x is the right-hand side, by positions, and becomes the solution.
  void solve(std::span<Vec2> x, const std::stop_token& stop) {
    std::vector<std::vector<double>> upper;  // of each supernode: its pivots' rows
    upper.reserve(nodes_.count());
    for (std::size_t s = 0; s < nodes_.count(); ++s) {
      throw_if_cancelled(stop);
      upper.push_back(eliminate(s, x));
    }
    for (std::size_t s = nodes_.count(); s-- > 0;) {
      check_cancelled_every(s, stop);
      substitute(s, upper[s], x);
    }
  }

 private:
  /// The update of a supernode to its parent: square, with kRhs more columns.
  struct Update {
    std::size_t supernode;
    std::vector<double> numbers;
  };

  [[nodiscard]] std::size_t size(std::size_t s) const {
    return nodes_.pivots(s) + nodes_.below(s).size();
  }

  std::vector<double> eliminate(std::size_t s, std::span<const Vec2> b) {
    const std::size_t stride = size(s) + kRhs;
    numbers_.assign(size(s) * stride, 0.0);
    const SquareFront front{numbers_.data(), nodes_.pivots(s), size(s), stride};
    assemble(s, b, front);
    if (!reduce_(front))
      throw Error(ErrorCode::solver_failed,
                  "the initial map's system is singular; choose initial lscm");
    Update left{s, {}};
    const std::size_t below = size(s) - front.pivots;
    left.numbers.reserve(below * (below + kRhs));
    for (std::size_t i = front.pivots; i < size(s); ++i)
      left.numbers.insert(left.numbers.end(), front.row(i) + front.pivots, front.row(i) + stride);
    waiting_.push_back(std::move(left));
    return {front.row(0), front.row(front.pivots)};
  }

  void assemble(std::size_t s, std::span<const Vec2> b, const SquareFront& front) {
    Index next = 0;
    for (Index k = nodes_.first[s]; k < nodes_.first[s + 1]; ++k) local_[at(k)] = next++;
    for (Index row : nodes_.below(s)) local_[at(row)] = next++;
    for (std::size_t k = at(nodes_.first[s]); k < at(nodes_.first[s + 1]); ++k) {
      for (std::size_t p = entry_begin_[k]; p < entry_begin_[k + 1]; ++p)
        front.row(at(local_[at(entries_[p].row)]))[local_[at(entries_[p].column)]] +=
            entries_[p].value;
      double* rhs = front.row(at(local_[k])) + front.size;
      rhs[0] = b[k].x(), rhs[1] = b[k].y();
    }
    for (Index c = 0; c < nodes_.child_count[s]; ++c) add_update(front);
  }

  /// Adds the update of the last waiting supernode.
  void add_update(const SquareFront& front) {
    const Update update = std::move(waiting_.back());
    waiting_.pop_back();
    const std::span<const Index> rows = nodes_.below(update.supernode);
    const double* from = update.numbers.data();
    for (Index row : rows) {
      double* to = front.row(at(local_[at(row)]));
      for (Index column : rows) to[local_[at(column)]] += *from++;
      for (std::size_t c = 0; c < kRhs; ++c) to[front.size + c] += *from++;
    }
  }

  /// x1 = U11^-1 (y1 - U12 x2)
  void substitute(std::size_t s, const std::vector<double>& upper, std::span<Vec2> x) const {
    const std::size_t pivots = nodes_.pivots(s), stride = size(s) + kRhs;
    const std::span<const Index> below = nodes_.below(s);
    Vec2* own = x.data() + nodes_.first[s];
    for (std::size_t k = pivots; k-- > 0;) {
      const double* row = upper.data() + k * stride;
      Vec2 sum(row[stride - 2], row[stride - 1]);
      for (std::size_t j = k + 1; j < pivots; ++j) sum -= row[j] * own[j];
      for (std::size_t j = 0; j < below.size(); ++j) sum -= row[pivots + j] * x[at(below[j])];
      own[k] = sum / row[k];
    }
  }

  const Supernodes& nodes_;
  Reduce reduce_;
  std::vector<std::size_t> entry_begin_;
  std::vector<Entry> entries_;
  std::vector<Index> local_;  ///< position of each row in the front
  std::vector<double> numbers_;
  std::vector<Update> waiting_;
};

void solve_by(Reduce reduce, const SparseMatrix& matrix, const std::stop_token& stop,
              std::span<Vec2> b) {
  const Supernodes nodes = analyse(graph_of(matrix), stop);
  std::vector<Vec2> x;
  x.reserve(b.size());
  for (Index v : nodes.order) x.push_back(b[at(v)]);
  DominantLu(matrix, nodes, reduce).solve(x, stop);
  for (std::size_t k = 0; k < x.size(); ++k) b[at(nodes.order[k])] = x[k];
}

}  // namespace

void solve_dominant(const SparseMatrix& matrix, std::span<Vec2> b, const std::stop_token& stop) {
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  solve_by(has_avx2 ? reduce_avx2 : reduce_on_baseline, matrix, stop, b);
}

void solve_dominant_on_baseline(const SparseMatrix& matrix, std::span<Vec2> b) {
  solve_by(reduce_on_baseline, matrix, {}, b);
}

}  // namespace unwrapd::linear
