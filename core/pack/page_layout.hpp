#pragma once
// Between islands and the cells of pages: what all ways of packing need.

#include <cstddef>
#include <vector>

#include "core/pack/anneal_packing.hpp"
#include "core/pack/bottom_left.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {

inline constexpr double kUsualFill = 0.7;    ///< of a page: boxes, without padding
inline constexpr double kSpareSide = 1.005;  ///< by which islands shrink beyond what seems to fit

/// Of all islands' boxes, in their units.
double box_area(const BottomLeftPlacer& placer);

/// Cells a side of a grid that gives each of so many islands about per_island of them, both ways;
/// no fewer than `least`, and no more than 4096.
int cells_for(std::size_t islands, double per_island, int least);

/// Cells a side of the grid that decides.
int fine_cells(std::size_t islands);

/// Cells a unit at which islands, in their boxes and with padding, seem to fill a usual share of so
/// many pages of `side` cells.
double usual_scale(const BottomLeftPlacer& placer, const PageGrid& grid, int pages, double side);

/// found: as it was made at the placer's scale.
std::vector<Placement> placements_of(const Found& found, BottomLeftPlacer& placer,
                                     const PageGrid& grid);

}  // namespace unwrapd::pack
