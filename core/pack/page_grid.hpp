#pragma once
// The cells of a page, the padding to its border taken off.

#include <algorithm>
#include <cmath>

namespace unwrapd::pack {

/// Of the padding: masks are made in time of its cells squared, and islands between such gaps are
/// placed to a 128th of them.
inline constexpr int kMostPaddingCells = 128;

struct PageGrid {
  double border = 0;  ///< the padding in page units, below 1/2

  /// Page units of one cell, `side` of which make a side.
  [[nodiscard]] double cell(int side) const { return (1 - 2 * border) / side; }

  /// The padding in such cells.
  [[nodiscard]] double padding(double side) const { return border * side / (1 - 2 * border); }

  /// A side of about so many cells, fewer where padding has many, for which the padding is a little
  /// less than whole cells: what is rounded up to the next is lost at every gap.
  [[nodiscard]] int tight_side(int side) const {
    const double margin = std::min<double>(std::round(padding(side)), kMostPaddingCells);
    return margin > 0 ? static_cast<int>(std::ceil(margin / padding(1))) - 1 : side;
  }
};

}  // namespace unwrapd::pack
