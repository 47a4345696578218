#pragma once
// The structure of a Cholesky factor: which column updates which, and how many entries each has.

#include <vector>

#include "core/linear/ordering.hpp"

namespace unwrapd::linear {

inline constexpr Index kNoParent = -1;

/// Columns are numbered in the order of elimination, which is a postorder of the tree: the
/// descendants of column k are the columns just before it.
struct EliminationTree {
  std::vector<Index> order;     ///< order[k]: the vertex eliminated k-th
  std::vector<Index> position;  ///< the inverse: position[order[k]] = k
  std::vector<Index> parent;    ///< of column k: the row of its first entry below the diagonal
  std::vector<Index> count;     ///< entries of column k of the factor, the diagonal included
};

/// order: any order of elimination. The tree has an equivalent one, with the same fill. Throws
/// Error{cancelled}.
EliminationTree elimination_tree(const Graph& graph, std::vector<Index> order,
                                 const std::stop_token& stop = {});

}  // namespace unwrapd::linear
