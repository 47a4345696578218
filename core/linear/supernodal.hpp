#pragma once
// Groups of columns of a Cholesky factor with (nearly) the same rows: dense blocks instead of lists
// of entries.

#include <span>
#include <vector>

#include "core/linear/elimination_tree.hpp"

namespace unwrapd::linear {

/// Supernode s owns the columns first[s] .. first[s+1]-1 and, below them, the rows below(s). They
/// come in postorder: the children of s are the last ones before it that no other supernode took.
struct Supernodes {
  std::vector<Index> order;        ///< order[k]: the vertex that is column k
  std::vector<Index> position;     ///< the inverse
  std::vector<Index> first;        ///< count() + 1 entries
  std::vector<Index> child_count;  ///< of each supernode
  std::vector<std::size_t> row_begin;
  std::vector<Index> row;  ///< of each supernode, ascending

  [[nodiscard]] std::size_t count() const { return child_count.size(); }
  [[nodiscard]] std::size_t pivots(std::size_t s) const {
    return static_cast<std::size_t>(first[s + 1] - first[s]);
  }
  [[nodiscard]] std::span<const Index> below(std::size_t s) const {
    return std::span(row).subspan(row_begin[s], row_begin[s + 1] - row_begin[s]);
  }
};

/// The structure of the factor, from the pattern of the matrix alone. Throws Error{cancelled}.
Supernodes analyse(const Graph& graph, const std::stop_token& stop = {});

/// The same for a given order of elimination.
Supernodes analyse(const Graph& graph, std::vector<Index> order, const std::stop_token& stop);

}  // namespace unwrapd::linear
