#pragma once
// Islands set down one after another on the cells of one or more pages.

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/pack/box.hpp"
#include "core/pack/occupancy.hpp"

namespace unwrapd::pack {

inline constexpr int kAnyTurn = -1;

/// In which order islands are set down, and how each is turned: kAnyTurn takes the best of all.
struct Arrangement {
  std::vector<Index> order;
  std::vector<int> turn;  ///< [island]
};

/// Where an island came to lie: its mask's lower left cell, its turn, its page.
struct CellPlace {
  int x = 0, y = 0;
  int turn = 0;
  int page = 0;
};

/// The pages in cells. height: islands that would reach beyond it find no place.
struct PageCells {
  int width = 0;
  int height = 0;
  int pages = 1;
};

struct PlacedIslands {
  std::vector<CellPlace> spots;  ///< [island]; of those that found a place
  bool is_complete = false;
  int placed = 0;          ///< islands that found a place before one did not
  int top = 0;             ///< cells, of the first page
  int pages = 1;           ///< that islands lie on
  double mean_height = 0;  ///< cells: of the islands' middles, by their cells
};

/// What a search may cost: words of bitmaps looked at. A measure of time that is the same on every
/// machine.
struct Budget {
  std::int64_t words = 0;
  std::stop_token stop = {};
};

/// Islands at one scale as masks, each turn made when it is first asked for.
class BottomLeftPlacer {
 public:
  /// outlines must outlive this. turns: a full circle is divided into so many; the first puts an
  /// island's right angles or its smallest box upright, or the squarest where it may span the page.
  BottomLeftPlacer(std::span<const charts::Outline> outlines, int turns);

  /// cells_per_unit: the islands' scale; padding: cells. Forgets masks of other figures.
  void set_scale(double cells_per_unit, double padding);

  /// Each island, in order, at the lowest free place of its turns, then the leftmost, on the first
  /// page that has one. Stops at the first that finds none. Throws Error{cancelled}.
  PlacedIslands lay(const Arrangement& arrangement, const PageCells& sheet, Budget& budget);

  [[nodiscard]] std::size_t size() const { return outlines_.size(); }
  [[nodiscard]] int turns() const { return turns_; }
  [[nodiscard]] const Box& box(std::size_t island) const { return boxes_[island]; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Turn turn_of(std::size_t island, int turn) const;
  const Mask& mask_of(std::size_t island, int turn);

  /// The least side of a page on which every island finds room for itself. Throws
  /// Error{cancelled}.
  int least_side(const std::stop_token& stop);

 private:
  struct Page;
  /// The lowest free place of one turn, if its top comes to lie below lowest_top.
  bool lower(std::size_t island, int turn, Page& page, CellPlace& spot, int& lowest_top);
  bool lay_one(std::size_t island, int turn, std::vector<Page>& pages, CellPlace& spot);

  std::span<const charts::Outline> outlines_;
  int turns_;
  double scale_ = 0, padding_ = 0;
  std::vector<Box> boxes_;
  std::vector<std::optional<Mask>> masks_;
};

}  // namespace unwrapd::pack
