#pragma once
// A packing made tighter: the page shrinks, and islands that then overlap move apart.

#include "core/pack/anneal_packing.hpp"

namespace unwrapd::pack {

struct CompactRules {
  int side = 0;      ///< cells of the page to begin with
  int reach = 0;     ///< cells that an island may move at once, each way; 0: anywhere, in any turn
  int step = 1;      ///< cells by which the page shrinks while that goes well
  int failures = 1;  ///< pages in a row on which islands found no place, then it ends
  int enough = 0;    ///< cells a side: a page no larger ends it too
};

/// from: one page, of any side: it is stretched to the one to begin with, and beyond where islands
/// do not get apart. Returns the smallest page that was found; side 0 when the budget ended before
/// any was. The placer's scale stays what it is. Throws Error{cancelled}.
Found compact(BottomLeftPlacer& placer, const Found& from, const CompactRules& rules,
              Budget& budget);

}  // namespace unwrapd::pack
