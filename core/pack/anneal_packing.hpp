#pragma once
// Which arrangement of islands needs the smallest pages.

#include <vector>

#include "core/pack/bottom_left.hpp"

namespace unwrapd::pack {

/// Islands on square pages of `side` cells.
struct Found {
  Arrangement arrangement;  ///< every turn decided
  std::vector<CellPlace> spots;
  int side = 0;  ///< 0: nothing was found
  int pages = 1;
};

/// Arrangements to begin with: the largest first, by several measures; every turn open.
std::vector<Arrangement> usual_arrangements(const BottomLeftPlacer& placer);

struct AnnealRules {
  int width = 0;    ///< cells, to begin with
  double heat = 0;  ///< share of the width by which a change may make things worse at first
  int enough = 0;   ///< cells a side: a page no larger ends the search
};

/// Looks for the smallest page that holds all, within the budget. What was found from each start,
/// the smallest first. The placer's scale stays what it is: the page shrinks.
std::vector<Found> smallest_page(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                                 const AnnealRules& rules, Budget& budget);

/// The same for several pages of one side.
Found smallest_pages(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                     int page_count, Budget& budget);

/// On pages of this side, as few as can be had of at most page_count; side 0 when they do not do.
Found fewest_pages(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                   const PageCells& sheet, Budget& budget);

}  // namespace unwrapd::pack
