#pragma once
// Converts between islands and the cells of pages, for all ways of packing.

#include <cstddef>
#include <vector>

#include "core/pack/anneal_packing.hpp"
#include "core/pack/bottom_left.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {

inline constexpr double kUsualFill = 0.7;  ///< of a page: boxes, without padding
inline constexpr double kSpareSide =
    1.005;  ///< by which islands shrink below the scale that seems to fit

/// The area of all islands' boxes, in their units.
double box_area(const BottomLeftPlacer& placer);

/// Cells a side of a grid that gives each island about per_island cells along both axes; at least
/// `least` and at most 4096.
int cells_for(std::size_t islands, double per_island, int least);

/// Cells a side of the final grid.
int fine_cells(std::size_t islands);

/// Cells a unit at which the islands' boxes, with padding, fill a usual share of `pages` pages of
/// `side` cells.
double usual_scale(const BottomLeftPlacer& placer, const PageGrid& grid, int pages, double side);

/// found: made at the placer's present scale.
std::vector<Placement> placements_of(const CellPacking& found, BottomLeftPlacer& placer,
                                     const PageGrid& grid);

}  // namespace unwrapd::pack
