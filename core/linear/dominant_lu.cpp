// Up-looking L U over an AMD ordering. With a symmetric pattern, row k of L and column k of U have
// the pattern of row k of the Cholesky factor: what the elimination tree reaches from A's row k. So
// the two are computed together, entry by entry along that reach, and stored together: node j keeps
// one list of indices k > j with l_kj and u_jk beside each. Rejected: Eigen's SparseLU, which
// orders and stores for partial pivoting (docs/adr/0009).
#include "core/linear/dominant_lu.hpp"

#include <Eigen/OrderingMethods>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"

namespace unwrapd {
namespace {

constexpr Index kNone = -1;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// The elimination tree of a symmetric pattern, and the reach of a row in it.
class EliminationTree {
 public:
  explicit EliminationTree(const SparseMatrix& a)
      : a_(a), parent_(at(static_cast<Index>(a.cols())), kNone), mark_(parent_.size(), kNone) {
    std::vector<Index> ancestor(parent_.size(), kNone);
    for (Index k = 0; k < static_cast<Index>(a.cols()); ++k)
      for (SparseMatrix::InnerIterator it(a, k); it && it.row() < k; ++it)
        climb(static_cast<Index>(it.row()), k, ancestor);
  }

  /// The columns j < k of row k of the factor, each before its ancestors.
  std::span<const Index> reach(Index k) {
    reach_.clear();
    mark_[at(k)] = k;
    for (SparseMatrix::InnerIterator it(a_, k); it && it.row() < k; ++it)
      for (Index j = static_cast<Index>(it.row()); mark_[at(j)] != k; j = parent_[at(j)]) {
        mark_[at(j)] = k;
        reach_.push_back(j);
      }
    std::sort(reach_.begin(), reach_.end());
    return reach_;
  }

 private:
  void climb(Index i, Index k, std::vector<Index>& ancestor) {
    while (i != kNone && i < k) {
      const Index next = std::exchange(ancestor[at(i)], k);
      if (next == kNone) parent_[at(i)] = k;
      i = next;
    }
  }

  const SparseMatrix& a_;
  std::vector<Index> parent_, mark_, reach_;
};

class DominantLu {
 public:
  explicit DominantLu(const SparseMatrix& a) : pivot_(at(static_cast<Index>(a.cols()))) {
    EliminationTree tree(a);
    count(a, tree);
    const SparseMatrix rows = a.transpose();  // column k holds row k of A
    std::vector<double> row(pivot_.size(), 0.0), column(pivot_.size(), 0.0);
    for (Index k = 0; k < static_cast<Index>(a.cols()); ++k) {
      for (SparseMatrix::InnerIterator it(a, k); it && it.row() <= k; ++it)
        column[at(static_cast<Index>(it.row()))] = it.value();
      for (SparseMatrix::InnerIterator it(rows, k); it && it.row() <= k; ++it)
        row[at(static_cast<Index>(it.row()))] = it.value();
      eliminate(k, tree.reach(k), row, column);
    }
  }

  void solve(std::span<Vec2> x) const {
    for (std::size_t j = 0; j < x.size(); ++j)
      for (std::size_t p = begin_[j]; p < end_[j]; ++p) x[at(index_[p])] -= lower_[p] * x[j];
    for (std::size_t j = x.size(); j-- > 0;) {
      for (std::size_t p = begin_[j]; p < end_[j]; ++p) x[j] -= upper_[p] * x[at(index_[p])];
      x[j] /= pivot_[j];
    }
  }

 private:
  void count(const SparseMatrix& a, EliminationTree& tree) {
    begin_.assign(pivot_.size() + 1, 0);
    for (Index k = 0; k < static_cast<Index>(a.cols()); ++k)
      for (Index j : tree.reach(k)) ++begin_[at(j) + 1];
    for (std::size_t j = 0; j < pivot_.size(); ++j) begin_[j + 1] += begin_[j];
    end_.assign(begin_.begin(), begin_.end() - 1);
    index_.resize(begin_.back());
    lower_.resize(begin_.back());
    upper_.resize(begin_.back());
  }

  /// Row k of L and column k of U from those above; clears row and column again.
  void eliminate(Index k, std::span<const Index> reach, std::vector<double>& row,
                 std::vector<double>& column) {
    double pivot = column[at(k)];
    row[at(k)] = column[at(k)] = 0;
    for (Index j : reach) {
      const double l = std::exchange(row[at(j)], 0.0) / pivot_[at(j)];
      const double u = std::exchange(column[at(j)], 0.0);
      for (std::size_t p = begin_[at(j)]; p < end_[at(j)]; ++p) {
        row[at(index_[p])] -= l * upper_[p];
        column[at(index_[p])] -= u * lower_[p];
      }
      pivot -= l * u;
      const std::size_t slot = end_[at(j)]++;
      index_[slot] = k, lower_[slot] = l, upper_[slot] = u;
    }
    if (!(std::abs(pivot) > 0) || !std::isfinite(pivot))
      throw Error(ErrorCode::solver_failed,
                  "the initial map's system is singular; choose initial lscm");
    pivot_[at(k)] = pivot;
  }

  std::vector<double> pivot_;             ///< u_kk
  std::vector<std::size_t> begin_, end_;  ///< node j's entries, filled up to end_
  std::vector<Index> index_;
  std::vector<double> lower_, upper_;  ///< l_kj, u_jk
};

}  // namespace

void solve_dominant(const SparseMatrix& matrix, std::span<Vec2> b) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
  Eigen::AMDOrdering<Index>()(matrix, order);
  const SparseMatrix permuted = order.transpose() * matrix * order;
  std::vector<Vec2> x(b.size());
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = b[at(order.indices()[static_cast<Eigen::Index>(k)])];
  DominantLu(permuted).solve(x);
  for (std::size_t k = 0; k < x.size(); ++k)
    b[at(order.indices()[static_cast<Eigen::Index>(k)])] = x[k];
}

}  // namespace unwrapd
