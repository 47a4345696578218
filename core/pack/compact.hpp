#pragma once
// Tightens a packing: the page shrinks, and islands that then overlap move apart.

#include "core/pack/anneal_packing.hpp"

namespace unwrapd::pack {

struct CompactRules {
  int side = 0;  ///< columns of cells of the first page
  int reach =
      0;  ///< cells that an island may move at once, each way; 0: anywhere, with any rotation
  int step = 1;      ///< cells by which the page shrinks after a success
  int failures = 1;  ///< ends after this many failures in a row
  int enough = 0;    ///< columns; a page no larger also ends it
  double ratio = 1;  ///< of a page's height to its width
};

/// from: one page of any side. It is scaled to the first page, and enlarged until the islands do
/// not overlap. Returns the smallest page that was found; side 0 if the budget ended before any
/// was. The placer keeps its scale. Throws Error{cancelled}.
CellPacking compact(BottomLeftPlacer& placer, const CellPacking& from, const CompactRules& rules,
                    Budget& budget);

}  // namespace unwrapd::pack
