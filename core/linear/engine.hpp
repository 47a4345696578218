#pragma once
// Our own engine behind the interface of factor.hpp: a supernodal Cholesky factor, found by the
// multifrontal method.

#include <memory>

#include "core/linear/factor.hpp"
#include "core/linear/supernodal.hpp"

namespace unwrapd {

/// What depends on the pattern of a matrix alone. One analysis serves any number of factors, of any
/// number of matrices with that pattern. Immutable: threads may share it.
struct Analysis {
  Supernodes nodes;
  /// Column k of the reordered matrix: entry_begin[k] .. entry_begin[k+1]-1 of the two lists.
  std::vector<Index> entry_begin;
  std::vector<Index> entry_row;          ///< in the new order, not above the diagonal
  std::vector<Index> entry_source;       ///< where among the matrix's values
  std::vector<std::size_t> panel_begin;  ///< of each supernode, and the end of the last
  std::size_t pending_size = 0;          ///< the most that updates ever occupy at once
};

/// lower: the lower triangle, compressed.
std::shared_ptr<const Analysis> analyse(const SparseMatrix& lower);

/// Nothing when the matrix, of the pattern analysed, is not positive definite in double precision.
std::unique_ptr<RealSystem> try_factor(std::shared_ptr<const Analysis> analysis,
                                       const SparseMatrix& lower);

}  // namespace unwrapd
