// The elimination tree with path compression (Liu, "The role of elimination trees in sparse
// factorization", 1990) and the factor's column counts from the leaves of its row subtrees
// (Gilbert, Ng, Peyton, "An efficient algorithm to compute row and column counts for sparse
// Cholesky factorization", 1994). Both nearly linear in the entries of the matrix. Rejected: the
// counts by merging the columns themselves, linear in the entries of the factor.
#include "core/linear/elimination_tree.hpp"

#include <algorithm>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {

std::vector<Index> inverse(std::span<const Index> order) {
  std::vector<Index> position(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) position[at(order[k])] = static_cast<Index>(k);
  return position;
}

std::vector<Index> parents(const Graph& graph, std::span<const Index> order,
                           const std::stop_token& stop) {
  const std::vector<Index> position = inverse(order);
  std::vector<Index> parent(order.size(), kNoParent), ancestor(order.size(), kNoParent);
  for (Index k = 0; k < static_cast<Index>(order.size()); ++k) {
    check_cancelled_every(k, stop);
    for (Index v : graph.of(order[at(k)]))
      for (Index j = position[at(v)]; j != kNoParent && j < k;) {
        const Index next = std::exchange(ancestor[at(j)], k);
        if (next == kNoParent) parent[at(j)] = k;
        j = next;
      }
  }
  return parent;
}

/// The first child of each column, and the next child of its parent; both ascending.
struct Children {
  std::vector<Index> first, next;
};

Children children_of(std::span<const Index> parent) {
  Children children{std::vector<Index>(parent.size(), kNoParent),
                    std::vector<Index>(parent.size(), kNoParent)};
  for (auto k = static_cast<Index>(parent.size()); k-- > 0;)
    if (parent[at(k)] != kNoParent)
      children.next[at(k)] = std::exchange(children.first[at(parent[at(k)])], k);
  return children;
}

/// Appends the subtree of a root in postorder. Consumes the lists of children.
void append_subtree(Index root, Children& children, std::vector<Index>& order) {
  std::vector<Index> path{root};
  while (!path.empty()) {
    const Index child = std::exchange(children.first[at(path.back())], kNoParent);
    if (child != kNoParent) {
      path.push_back(child);
      continue;
    }
    order.push_back(path.back());
    const Index sibling = children.next[at(path.back())];
    path.pop_back();
    if (sibling != kNoParent) path.push_back(sibling);
  }
}

std::vector<Index> postorder(std::span<const Index> parent) {
  Children children = children_of(parent);
  std::vector<Index> order;
  order.reserve(parent.size());
  for (std::size_t k = 0; k < parent.size(); ++k)
    if (parent[k] == kNoParent) append_subtree(static_cast<Index>(k), children, order);
  return order;
}

/// The tree in postorder, without counts.
EliminationTree in_postorder(std::span<const Index> order, std::span<const Index> parent) {
  const std::vector<Index> old = postorder(parent);
  const std::vector<Index> renumbered = inverse(old);
  EliminationTree tree;
  for (Index k : old) {
    tree.order.push_back(order[at(k)]);
    const Index p = parent[at(k)];
    tree.parent.push_back(p == kNoParent ? kNoParent : renumbered[at(p)]);
  }
  tree.position = inverse(tree.order);
  return tree;
}

/// Finds the entries of the matrix that are leaves of row subtrees; columns come in postorder.
class RowSubtrees {
 public:
  explicit RowSubtrees(std::span<const Index> parent)
      : parent_(parent),
        first_(parent.size(), kNoParent),
        last_first_(parent.size(), kNoParent),
        last_leaf_(parent.size(), kNoParent),
        ancestor_(parent.size()) {
    for (std::size_t k = 0; k < parent.size(); ++k) {
      ancestor_[k] = static_cast<Index>(k);
      if (first_[k] == kNoParent) first_[k] = static_cast<Index>(k);
      if (parent[k] != kNoParent && first_[at(parent[k])] == kNoParent)
        first_[at(parent[k])] = first_[k];
    }
  }

  [[nodiscard]] bool is_tree_leaf(Index k) const { return first_[at(k)] == k; }

  /// Must be called after the last query for column j.
  void finish(Index j) {
    if (parent_[at(j)] != kNoParent) ancestor_[at(j)] = parent_[at(j)];
  }

  /// Whether column j is a leaf of the subtree of row i > j.
  bool is_leaf(Index i, Index j) {
    if (first_[at(j)] <= last_first_[at(i)]) return false;
    last_first_[at(i)] = first_[at(j)];
    previous_ = std::exchange(last_leaf_[at(i)], j);
    return true;
  }

  /// The column where the paths of the last leaf and of the leaf before it meet; kNoParent if there
  /// is no leaf before it.
  Index meeting() {
    if (previous_ == kNoParent) return kNoParent;
    Index top = previous_;
    while (top != ancestor_[at(top)]) top = ancestor_[at(top)];
    for (Index k = previous_; k != top;) k = std::exchange(ancestor_[at(k)], top);
    return top;
  }

 private:
  std::span<const Index> parent_;
  std::vector<Index> first_;       ///< the first descendant of each column
  std::vector<Index> last_first_;  ///< of each row: the first descendant of its last leaf
  std::vector<Index> last_leaf_;   ///< of each row
  std::vector<Index> ancestor_;    ///< a forest of the finished columns, paths compressed
  Index previous_ = kNoParent;
};

/// Each leaf of a row subtree adds one to the counts on its path to the root; the node where two
/// paths meet subtracts one.
void count_leaves(const Graph& graph, const EliminationTree& tree, Index j, RowSubtrees& subtrees,
                  std::span<Index> count) {
  for (Index v : graph.of(tree.order[at(j)])) {
    const Index i = tree.position[at(v)];
    if (i < j || !subtrees.is_leaf(i, j)) continue;
    ++count[at(j)];
    if (const Index m = subtrees.meeting(); m != kNoParent) --count[at(m)];
  }
}

/// Sums differences along the tree: a column has the entries of its children without their
/// diagonals.
std::vector<Index> column_counts(const Graph& graph, const EliminationTree& tree,
                                 const std::stop_token& stop) {
  RowSubtrees subtrees(tree.parent);
  std::vector<Index> count(tree.parent.size());
  for (Index j = 0; j < static_cast<Index>(count.size()); ++j) {
    check_cancelled_every(j, stop);
    count[at(j)] += subtrees.is_tree_leaf(j) ? 1 : 0;
    if (tree.parent[at(j)] != kNoParent) --count[at(tree.parent[at(j)])];
    count_leaves(graph, tree, j, subtrees, count);
    subtrees.finish(j);
  }
  for (std::size_t j = 0; j < count.size(); ++j)
    if (tree.parent[j] != kNoParent) count[at(tree.parent[j])] += count[j];
  return count;
}

}  // namespace

EliminationTree elimination_tree(const Graph& graph, std::vector<Index> order,
                                 const std::stop_token& stop) {
  const std::vector<Index> parent = parents(graph, order, stop);
  throw_if_cancelled(stop);
  EliminationTree tree = in_postorder(order, parent);
  throw_if_cancelled(stop);
  tree.count = column_counts(graph, tree, stop);
  return tree;
}

}  // namespace unwrapd::linear
