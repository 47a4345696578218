#pragma once
// Places islands one after another, each time the one that touches most of those already placed.

#include <stop_token>

#include "core/pack/anneal_packing.hpp"

namespace unwrapd::pack {

/// The score of a place: the share of the island's outline that touches others or the page's sides,
/// less a penalty for height, plus a bonus for large islands, which must be placed early.
struct TouchingRules {
  double low = 0;    ///< penalty per mean island side of height
  double large = 0;  ///< bonus per mean island side of size
};

struct TouchingPage {
  CellPacking found = {};  ///< side 0: the islands do not fit
  int height = 0;          ///< cells: height of the strip
};

/// Places the islands in a strip of this width, cells, at most half as high again as a page of
/// this ratio of height to width. The next island is one of the 100 largest left (fewer if there
/// are more than 400) with any rotation, each at its lowest free place. Throws Error{cancelled}.
TouchingPage place_by_touching_perimeter(BottomLeftPlacer& placer, int width,
                                         const TouchingRules& rules, const std::stop_token& stop,
                                         double ratio = 1);

}  // namespace unwrapd::pack
