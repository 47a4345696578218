#include "core/pack/page_layout.hpp"

#include <algorithm>
#include <cmath>

namespace unwrapd::pack {
namespace {

constexpr int kFineCells = 1024, kMostCells = 4096;  // a side
constexpr double kFinePerIsland = 30;
constexpr double kFullBoxes = 0.9;  // of a page: boxes with their padding

}  // namespace

double box_area(const BottomLeftPlacer& placer) {
  double area = 0;
  for (std::size_t k = 0; k < placer.size(); ++k) area += placer.box(k).size.prod();
  return area;
}

int cells_for(std::size_t islands, double per_island, int least) {
  const double wanted = per_island * std::sqrt(static_cast<double>(islands));
  return static_cast<int>(std::clamp<double>(wanted, least, kMostCells));
}

int fine_cells(std::size_t islands) { return cells_for(islands, kFinePerIsland, kFineCells); }

double usual_scale(const BottomLeftPlacer& placer, const PageGrid& grid, int pages, double side) {
  const double margin = grid.padding(side), all = static_cast<double>(placer.size());
  double half = 0;  // of the equation area s^2 + 2 half s + all margin^2 = room
  for (std::size_t k = 0; k < placer.size(); ++k) half += placer.box(k).size.sum() * margin / 2;
  const double area = box_area(placer);
  const double ratio = grid.ratio();
  const double room = kFullBoxes * pages * side * side * ratio - all * margin * margin;
  const double least = 0.2 * side * side * ratio;
  return (std::sqrt(half * half + area * std::max(room, least)) - half) / area;
}

std::vector<Placement> placements_of(const CellPacking& found, BottomLeftPlacer& placer,
                                     const PageGrid& grid) {
  const double cell = grid.cell(found.side);
  std::vector<Placement> placements;
  for (std::size_t k = 0; k < found.spots.size(); ++k) {
    const CellPlace& spot = found.spots[k];
    const Turn turn = placer.turn_of(k, spot.turn);
    const Vec2 moved = Vec2(spot.x, spot.y) - placer.mask_of(k, spot.turn).low;
    placements.push_back({turn.cosine, turn.sine, cell * turn.scale,
                          Vec2(Vec2::Constant(grid.border) + cell * moved + Vec2(spot.page, 0))});
  }
  return placements;
}

}  // namespace unwrapd::pack
