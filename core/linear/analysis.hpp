#pragma once
// All that depends only on the pattern of a symmetric matrix: its order of elimination, the layout
// of its factor, and the memory that it takes.

#include <memory>
#include <span>
#include <vector>

#include "core/linear/branches.hpp"
#include "core/linear/front_panel.hpp"
#include "core/linear/sparse.hpp"
#include "core/linear/supernodal.hpp"
#include "core/types/cache_key.hpp"

namespace unwrapd::linear {

/// One analysis serves any number of factors, of any number of matrices with its pattern.
/// Immutable: threads may share it.
struct Analysis {
  Supernodes nodes;
  Branches branches;  ///< of the supernodes, balanced by the sizes of their panels
  /// Column k of the reordered matrix: entry_begin[k] .. entry_begin[k+1]-1 of the two lists.
  std::vector<Index> entry_begin;
  std::vector<Index> entry_row;          ///< in the new order, not above the diagonal
  std::vector<Index> entry_source;       ///< index among the matrix's values
  std::vector<std::size_t> panel_begin;  ///< of each supernode, then the end of the last
  std::size_t pending_size = 0;          ///< the most numbers that updates ever occupy at once

  /// Bytes of this object; of a factor's panels; of the largest front and the waiting updates while
  /// a factor is computed; and of all of these.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t panel_bytes() const { return sizeof(double) * panel_begin.back(); }
  [[nodiscard]] std::size_t scratch_bytes() const;
  [[nodiscard]] std::size_t job_bytes() const { return bytes() + panel_bytes() + scratch_bytes(); }

  [[nodiscard]] PanelShape shape(std::size_t s) const {
    return {nodes.pivots(s), nodes.below(s).size()};
  }
};

/// The size of an update of n rows: its lower triangle.
constexpr std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

/// The most numbers that the updates of a subtree ever occupy at once.
std::size_t most_pending(const Supernodes& nodes, Branch branch);

/// The positions of a matrix's entries: the input of an analysis.
struct SparsePattern {
  /// matrix: compressed; it must outlive the pattern.
  SparsePattern(const SparseMatrix& matrix);  // NOLINT(google-explicit-constructor): it is its own

  std::span<const Index> begin;  ///< of each column in row, then the end of the last
  std::span<const Index> row;

  [[nodiscard]] Index columns() const { return static_cast<Index>(begin.size()) - 1; }
};
void describe(CacheKey& key, const SparsePattern& pattern);

/// lower: the lower triangle. Throws Error{cancelled}.
std::shared_ptr<const Analysis> analyse(const SparsePattern& lower,
                                        const std::stop_token& stop = {});

/// The same for a matrix whose rows are already in a good order of elimination, which is kept.
std::shared_ptr<const Analysis> analyse_in_order(const SparsePattern& lower,
                                                 const std::stop_token& stop = {});

/// As analyse(), for a matrix with two unknowns a vertex, rows 2v and 2v+1, whose entries come in
/// whole blocks of two by two (on the diagonal the lower triangle of each). It orders vertices,
/// with a quarter of the graph. Values are those of the given matrix.
std::shared_ptr<const Analysis> analyse_pairs(const SparsePattern& lower,
                                              const std::stop_token& stop = {});

}  // namespace unwrapd::linear
