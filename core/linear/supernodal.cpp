// Chains of the elimination tree whose columns have the same rows become supernodes; a supernode is
// then merged with its parent where that stores few zeros, because small dense blocks cost more in
// overhead than zeros cost in arithmetic (relaxed amalgamation: Ashcraft, Grimes 1989; thresholds
// as in Chen, Davis, Hager, Rajamanickam, "CHOLMOD", 2008). The rows follow from the row subtrees
// of the merged tree, which lists them in ascending order without sorting.
#include "core/linear/supernodal.hpp"

#include <utility>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {

constexpr Index kUnset = -1;

/// A dense trapezoid: columns with their rows, the columns' own rows included.
struct Block {
  double columns, rows, zeros;

  [[nodiscard]] double entries() const {
    return columns * (columns + 1) / 2 + columns * (rows - columns);
  }
};

Block merge_blocks(const Block& child, const Block& parent) {
  const double missing = child.columns * (child.columns + parent.rows - child.rows);
  return {child.columns + parent.columns, child.columns + parent.rows,
          child.zeros + parent.zeros + missing};
}

bool is_worth_merging(const Block& both) {
  const double share = both.zeros / both.entries();
  return both.columns <= 4 || both.zeros == 0 || (both.columns <= 16 && share < 0.8) ||
         (both.columns <= 48 && share < 0.1) || share < 0.05;
}

/// The first column of each supernode, and the end of the last.
std::vector<Index> maximal_supernodes(const EliminationTree& tree) {
  const auto n = static_cast<Index>(tree.parent.size());
  std::vector<Index> first;
  for (Index k = 0; k < n; ++k)
    if (k == 0 || tree.parent[at(k - 1)] != k || tree.count[at(k - 1)] != tree.count[at(k)] + 1)
      first.push_back(k);
  first.push_back(n);
  return first;
}

/// Merges supernodes with their parents, from the roots down, where the parent follows at once.
std::vector<Index> relaxed_supernodes(const EliminationTree& tree) {
  const std::vector<Index> first = maximal_supernodes(tree);
  std::vector<Index> kept{first.back()};
  Block parent{};
  for (std::size_t s = first.size() - 1; s-- > 0;) {
    const Index last = first[s + 1] - 1;
    const Block own{double(first[s + 1] - first[s]), double(tree.count[at(first[s])]), 0};
    const Block both = merge_blocks(own, parent);
    if (tree.parent[at(last)] == first[s + 1] && is_worth_merging(both)) {
      kept.back() = first[s];
      parent = both;
    } else {
      kept.push_back(first[s]);
      parent = own;
    }
  }
  return {kept.rbegin(), kept.rend()};
}

std::vector<Index> supernode_of_columns(std::span<const Index> first) {
  std::vector<Index> supernode(at(first.back()));
  for (std::size_t s = 0; s + 1 < first.size(); ++s)
    for (Index k = first[s]; k < first[s + 1]; ++k) supernode[at(k)] = static_cast<Index>(s);
  return supernode;
}

/// Collects the rows of supernodes: row i belongs to every supernode on the path from those of its
/// entries up to its own.
class RowLists {
 public:
  RowLists(const std::vector<std::size_t>& begin, std::span<const Index> parent)
      : row(begin.back()),
        parent_(parent),
        reached_(parent.size(), kUnset),
        next_(begin.begin(), begin.end() - 1) {}

  void start(Index i, Index own_supernode) { reached_[at(own_supernode)] = i; }

  void climb(Index i, Index s) {
    for (; reached_[at(s)] != i; s = parent_[at(s)]) {
      reached_[at(s)] = i;
      row[next_[at(s)]++] = i;
    }
  }

  std::vector<Index> row;

 private:
  std::span<const Index> parent_;
  std::vector<Index> reached_;  ///< of each supernode: the last row that reached it
  std::vector<std::size_t> next_;
};

std::vector<Index> rows_of(const Graph& graph, const Supernodes& nodes,
                           std::span<const Index> supernode, std::span<const Index> parent,
                           const std::stop_token& stop) {
  RowLists lists(nodes.row_begin, parent);
  for (Index i = 0; i < static_cast<Index>(supernode.size()); ++i) {
    check_cancelled_every(i, stop);
    lists.start(i, supernode[at(i)]);
    for (Index v : graph.of(nodes.order[at(i)]))
      if (const Index j = nodes.position[at(v)]; j < i) lists.climb(i, supernode[at(j)]);
  }
  return std::move(lists.row);
}

}  // namespace

Supernodes analyse(const Graph& graph, std::vector<Index> order, const std::stop_token& stop) {
  EliminationTree tree = elimination_tree(graph, std::move(order), stop);
  throw_if_cancelled(stop);
  Supernodes nodes;
  nodes.first = relaxed_supernodes(tree);
  const std::vector<Index> supernode = supernode_of_columns(nodes.first);
  const std::size_t count = nodes.first.size() - 1;
  nodes.child_count.assign(count, 0);
  nodes.row_begin.assign(count + 1, 0);
  std::vector<Index> parent(count, kUnset);
  for (std::size_t s = 0; s < count; ++s) {
    const std::size_t last = at(nodes.first[s + 1] - 1);
    nodes.row_begin[s + 1] = nodes.row_begin[s] + at(tree.count[last] - 1);
    if (tree.parent[last] == kNoParent) continue;
    parent[s] = supernode[at(tree.parent[last])];
    ++nodes.child_count[at(parent[s])];
  }
  nodes.order = std::move(tree.order);
  nodes.position = std::move(tree.position);
  nodes.row = rows_of(graph, nodes, supernode, parent, stop);
  return nodes;
}

Supernodes analyse(const Graph& graph, const std::stop_token& stop) {
  return analyse(graph, fill_reducing_order(graph, stop), stop);
}

}  // namespace unwrapd::linear
