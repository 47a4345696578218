#pragma once
// The cells of a page, the padding to its border taken off.

#include <cmath>

namespace unwrapd {

struct PageGrid {
  double border = 0;  ///< the padding in page units, below 1/2

  /// Page units of one cell, `side` of which make a side.
  [[nodiscard]] double cell(int side) const { return (1 - 2 * border) / side; }

  /// The padding in such cells.
  [[nodiscard]] double padding(double side) const { return border * side / (1 - 2 * border); }

  /// A side of about so many cells for which the padding is a little less than whole cells: what
  /// is rounded up to the next is lost at every gap.
  [[nodiscard]] int tight_side(int side) const {
    const double margin = std::round(padding(side));
    return margin > 0 ? static_cast<int>(std::ceil(margin / padding(1))) - 1 : side;
  }
};

}  // namespace unwrapd
