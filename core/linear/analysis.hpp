#pragma once
// What depends on the pattern of a symmetric matrix alone: its order of elimination, where its
// factor's numbers go, how much memory they take.

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
  Branches branches;  ///< of the supernodes, by the sizes of their panels
  /// Column k of the reordered matrix: entry_begin[k] .. entry_begin[k+1]-1 of the two lists.
  std::vector<Index> entry_begin;
  std::vector<Index> entry_row;          ///< in the new order, not above the diagonal
  std::vector<Index> entry_source;       ///< where among the matrix's values
  std::vector<std::size_t> panel_begin;  ///< of each supernode, and the end of the last
  std::size_t pending_size = 0;          ///< the most that updates ever occupy at once

  /// Bytes that this takes; that a factor's panels take; that finding their numbers takes beside
  /// them, for the largest front and the updates that wait; and all of these.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t panel_bytes() const { return sizeof(double) * panel_begin.back(); }
  [[nodiscard]] std::size_t scratch_bytes() const;
  [[nodiscard]] std::size_t job_bytes() const { return bytes() + panel_bytes() + scratch_bytes(); }

  [[nodiscard]] PanelShape shape(std::size_t s) const {
    return {nodes.pivots(s), nodes.below(s).size()};
  }
};

/// Numbers of an update of n rows: its lower triangle.
constexpr std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

/// The most numbers that the updates of a subtree ever occupy at once.
std::size_t most_pending(const Supernodes& nodes, Branch branch);

/// Where a matrix has entries: all that an analysis reads of it.
struct SparsePattern {
  /// matrix: compressed; it must outlive the pattern.
  SparsePattern(const SparseMatrix& matrix);  // NOLINT(google-explicit-constructor): it is its own

  std::span<const Index> begin;  ///< of each column among row, and the end of the last
  std::span<const Index> row;

  [[nodiscard]] Index columns() const { return static_cast<Index>(begin.size()) - 1; }
};
void describe(CacheKey& key, const SparsePattern& pattern);

/// lower: the lower triangle. Throws Error{cancelled}.
std::shared_ptr<const Analysis> analyse(const SparsePattern& lower,
                                        const std::stop_token& stop = {});

/// The same, of a matrix whose rows are numbered in a good order of elimination: none is looked
/// for.
std::shared_ptr<const Analysis> analyse_in_order(const SparsePattern& lower,
                                                 const std::stop_token& stop = {});

/// As analyse(), of a matrix with two unknowns a vertex, rows 2v and 2v+1, whose entries come in
/// whole blocks of two by two (of the diagonal ones the lower triangle): ordered by vertices, a
/// quarter of the graph. Values are those of the given, not the halved, matrix.
std::shared_ptr<const Analysis> analyse_pairs(const SparsePattern& lower,
                                              const std::stop_token& stop = {});

}  // namespace unwrapd::linear
