#pragma once
// Islands set down one after another, each time the one that touches most of what lies there.

#include <stop_token>

#include "core/pack/anneal_packing.hpp"

namespace unwrapd::pack {

/// What a place is worth: the share of the island's outline that touches others or the page's
/// sides, less by how high it lies, and more for large islands, which must come soon.
struct TouchingRules {
  double low = 0;    ///< for each mean island's side that its middle lies higher
  double large = 0;  ///< for each mean island's side that it measures itself
};

struct TouchingPage {
  Found found = {};  ///< side 0: the islands do not fit in
  int height = 0;    ///< cells, of the strip that they take
};

/// In a strip of this width, cells, and at most half as high again. The next island is one of the
/// 100 largest that are left (fewer where they are over 400) in any turn, each at its lowest free
/// place. Throws Error{cancelled}.
TouchingPage place_by_touching_perimeter(BottomLeftPlacer& placer, int width,
                                         const TouchingRules& rules, const std::stop_token& stop);

}  // namespace unwrapd::pack
