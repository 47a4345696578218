#pragma once
// The finished columns of a supernode, in the layout of the solves.

#include <algorithm>
#include <cstddef>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::linear {

inline constexpr std::size_t kPack = 4;  ///< columns that are processed at once
inline constexpr std::size_t kDuo = 2;   ///< rows that are processed at once

constexpr std::size_t padded(std::size_t n, std::size_t to) { return (n + to - 1) / to * to; }

/// A panel holds [L11^-1; L21 L11^-1] of `pivots` columns with `below` rows under them. Columns
/// come in blocks of kPack. A block starts at the row of its first column, zeros above the diagonal
/// included, and ends at height(). In it, two rows of each column follow two rows of the column
/// before: one cache line holds two rows of the block, and solves read all lines in order.
struct PanelShape {
  std::size_t pivots;
  std::size_t below;

  [[nodiscard]] std::size_t height() const { return padded(pivots + below, kDuo); }

  /// The start of the block whose first column is k, a multiple of kPack.
  [[nodiscard]] std::size_t block_begin(std::size_t k) const {
    return k * height() - k * (k - kPack) / 2;
  }
  /// The number of columns of that block.
  [[nodiscard]] std::size_t width(std::size_t k) const { return std::min(kPack, pivots - k); }

  /// The position of row r of column k + c, in the block that starts with column k.
  [[nodiscard]] std::size_t entry(std::size_t r, std::size_t k, std::size_t c) const {
    return block_begin(k) + ((r - k) / kDuo * width(k) + c) * kDuo + r % kDuo;
  }

  [[nodiscard]] std::size_t size() const {
    const std::size_t whole = pivots / kPack * kPack;
    return block_begin(whole) + (pivots - whole) * (height() - whole);
  }
};

/// Two right-hand sides u and v over the rows of one panel: 2 * height() numbers, for every two
/// rows u of both and then v of both.
using PanelRows = double*;

/// The position of u of row r; v is kDuo after it.
constexpr std::size_t row_entry(std::size_t r) { return 2 * (r / kDuo * kDuo) + r % kDuo; }

/// Products of a panel with two right-hand sides. The same bits on any processor.
struct PanelKernels {
  /// sum = panel * x: one x a pivot.
  void (*multiply)(const double* panel, PanelShape shape, const Vec2* x, PanelRows sum);
  /// x = panel^T * y
  void (*multiply_transposed)(const double* panel, PanelShape shape, const double* y, Vec2* x);
};

/// The kernels for the registers of this processor; those for the x86-64 baseline.
PanelKernels panel_kernels();
PanelKernels baseline_panel_kernels();

}  // namespace unwrapd::linear
