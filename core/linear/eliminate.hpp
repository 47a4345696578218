#pragma once
// Eliminates fixed vertices from a symmetric or Hermitian system: their columns, times their
// values, go to the right-hand side; the rows and columns of the others stay.

#include <complex>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {

inline constexpr Index kFixed = -1;

/// slot[v]: the row of vertex v among the free ones, ascending with v, or kFixed.
struct FreeVertices {
  std::vector<Index> slot;
  Index count = 0;
};

/// Numbers the vertices for which fixed[v] is 0.
inline FreeVertices number_free(std::span<const char> fixed) {
  FreeVertices free{std::vector<Index>(fixed.size(), kFixed), 0};
  for (std::size_t v = 0; v < fixed.size(); ++v)
    if (fixed[v] == 0) free.slot[v] = free.count++;
  return free;
}

/// The reduced system. Matrix: Eigen column-major, of real or complex scalars; Value: the values of
/// a vertex (Vec2 or Complex).
template <typename Matrix, typename Value>
struct ReducedSystem {
  Matrix lower;
  std::vector<Value> rhs;
};

/// lower: the lower triangle of the full matrix A of A u = 0 at the free vertices; value[v]: the
/// values of the fixed ones (others are not read). Throws Error{cancelled}.
template <typename Matrix, typename Value>
ReducedSystem<Matrix, Value> eliminate(const Matrix& lower, const FreeVertices& free,
                                       std::span<const Value> value,
                                       const std::stop_token& stop = {}) {
  ReducedSystem<Matrix, Value> r;
  r.lower.resize(free.count, free.count);
  r.rhs.assign(static_cast<std::size_t>(free.count), Value(value[0] * 0.0));
  r.lower.reserve(lower.nonZeros());
  const auto pull = [&](Index row, Index fixed, const auto& entry) {
    r.rhs[static_cast<std::size_t>(row)] -= entry * value[static_cast<std::size_t>(fixed)];
  };
  for (Index j = 0; j < static_cast<Index>(lower.cols()); ++j) {
    check_cancelled_every(j, stop);
    const Index column = free.slot[static_cast<std::size_t>(j)];
    if (column != kFixed) r.lower.startVec(column);
    for (typename Matrix::InnerIterator it(lower, j); it; ++it) {
      const auto i = static_cast<Index>(it.row());
      const Index row = free.slot[static_cast<std::size_t>(i)];
      if (row != kFixed && column != kFixed)
        r.lower.insertBack(row, column) = it.value();
      else if (row != kFixed)
        pull(row, j, it.value());
      else if (column != kFixed)
        pull(column, i, Eigen::numext::conj(it.value()));
    }
  }
  r.lower.finalize();
  return r;
}

}  // namespace unwrapd::linear
