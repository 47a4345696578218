#pragma once
// The cells of a page, without the padding at its border.

#include <algorithm>
#include <cmath>

namespace unwrapd::pack {

/// Upper bound of the padding, in cells: a mask costs time quadratic in it, and islands with such
/// wide gaps are placed to a 128th of them.
inline constexpr int kMostPaddingCells = 128;

struct PageGrid {
  double border = 0;  ///< the padding in page units, below 1/2

  /// Page units of one cell, if a side has `side` cells.
  [[nodiscard]] double cell(int side) const { return (1 - 2 * border) / side; }

  /// The padding in such cells.
  [[nodiscard]] double padding(double side) const { return border * side / (1 - 2 * border); }

  /// A side of about that many cells, less if the padding has many, for which the padding is a
  /// little below a whole number of cells. The padding is rounded up to whole cells at every gap.
  [[nodiscard]] int tight_side(int side) const {
    const double margin = std::min<double>(std::round(padding(side)), kMostPaddingCells);
    return margin > 0 ? static_cast<int>(std::ceil(margin / padding(1))) - 1 : side;
  }
};

}  // namespace unwrapd::pack
