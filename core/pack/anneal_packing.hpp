#pragma once
// Searches the arrangement of islands that needs the smallest pages, by threshold accepting.

#include <vector>

#include "core/pack/bottom_left.hpp"

namespace unwrapd::pack {

/// Islands on pages of `side` columns of cells.
struct CellPacking {
  Arrangement arrangement;  ///< all rotations are chosen
  std::vector<CellPlace> spots;
  int side = 0;  ///< 0: nothing was found
  int pages = 1;
};

/// Initial arrangements: the largest island first, by several measures; all rotations open.
std::vector<Arrangement> usual_arrangements(const BottomLeftPlacer& placer);

struct AnnealRules {
  int width = 0;    ///< cells, to begin with
  double heat = 0;  ///< rise of the height that is accepted at first, in widths
  int enough = 0;   ///< cells a side; a page no larger ends the search
};

/// Searches the smallest page that holds all islands, within the budget. Returns the best packing
/// from each start, the smallest first. The placer keeps its scale: the page shrinks.
std::vector<CellPacking> smallest_page(BottomLeftPlacer& placer,
                                       const std::vector<Arrangement>& starts,
                                       const AnnealRules& rules, Budget& budget);

/// Several pages of one shape.
struct PagesWanted {
  int count = 1;
  double ratio = 1;  ///< of a page's height to its width
};

/// The same for several pages of one size.
CellPacking smallest_pages(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                           const PagesWanted& pages, Budget& budget);

/// Searches for as few pages of this size as possible, at most sheet.pages; side 0 if the islands
/// do not fit.
CellPacking fewest_pages(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                         const PageCells& sheet, Budget& budget);

}  // namespace unwrapd::pack
