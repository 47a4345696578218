#pragma once
// The cells of a page, without the padding at its border.

#include <algorithm>
#include <cmath>

namespace unwrapd::pack {

/// Upper bound of the padding, in cells: a mask costs time quadratic in it, and islands with such
/// wide gaps are placed to a 128th of them.
inline constexpr int kMostPaddingCells = 128;

/// The rows of cells of a page of so many columns. ratio: of its height to its width, without the
/// padding at its border.
inline int rows_of(int columns, double ratio) {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(columns * ratio * (1 + kRounding)));
}

/// The least number of columns of a page that has so many rows.
inline int columns_for(int rows, double ratio) {
  int columns = std::max(1, static_cast<int>(std::ceil(rows / ratio)));
  while (rows_of(columns, ratio) < rows) ++columns;
  while (columns > 1 && rows_of(columns - 1, ratio) >= rows) --columns;
  return columns;
}

/// Cells are square. `side` counts those along U, the page's unit.
struct PageGrid {
  double border = 0;  ///< the padding in page units, below 1/2
  double aspect = 1;  ///< the page's height in page units, above 2 * border

  /// Of the height to the width, without the padding at the border.
  [[nodiscard]] double ratio() const { return (aspect - 2 * border) / (1 - 2 * border); }

  /// Columns of a page with about as many cells as a square one of this side.
  [[nodiscard]] int columns(int side) const {
    return aspect == 1 ? side
                       : std::max(1, static_cast<int>(std::lround(side / std::sqrt(aspect))));
  }

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
