#pragma once
// Places islands one after another on the cells of one or more pages.

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/pack/box.hpp"
#include "core/pack/occupancy.hpp"

namespace unwrapd::pack {

inline constexpr int kAnyTurn = -1;

/// The order in which islands are placed, and the rotation of each: kAnyTurn takes the best of all.
struct Arrangement {
  std::vector<Index> order;
  std::vector<int> turn;  ///< [island]
};

/// The position of an island: its mask's lower left cell, its rotation, its page.
struct CellPlace {
  int x = 0, y = 0;
  int turn = 0;
  int page = 0;
};

/// Cells that are taken before any island is placed: the touched ones of a mask at (x, y).
struct TakenCells {
  Mask mask;
  int x = 0, y = 0;
  int page = 0;
};

/// The pages in cells. height: an island that would reach beyond it has no place.
struct PageCells {
  int width = 0;
  int height = 0;
  int pages = 1;
  std::span<const TakenCells> taken = {};  ///< within the margin around the pages
};

struct PlacedIslands {
  std::vector<CellPlace> spots;  ///< [island]; valid if the island has a place
  bool is_complete = false;
  int placed = 0;          ///< islands placed before the first that has no place
  int top = 0;             ///< cells, of the first page
  int pages = 1;           ///< number of pages that have islands
  double mean_height = 0;  ///< cells: the mean height of the islands' centres, by area
};

/// The budget of a search, in words of bitmaps that it reads. It measures time independently of the
/// machine.
struct Budget {
  std::int64_t words = 0;
  std::stop_token stop = {};
};

/// Islands at one scale as masks. The mask of each rotation is made when it is first needed.
class BottomLeftPlacer {
 public:
  /// outlines must outlive this. turns: the number of rotations in a full circle, where `rotation`
  /// leaves the choice. The first puts an island's right angles or its smallest box upright, or,
  /// with any rotation, its squarest box if it may span the page.
  BottomLeftPlacer(std::span<const charts::Outline> outlines, int turns,
                   Rotation rotation = Rotation::any);

  /// cells_per_unit: the islands' scale; padding: cells. Drops masks of other values.
  void set_scale(double cells_per_unit, double padding);

  /// So many times as many rotations in a full circle, where islands may turn freely: turn k of
  /// before is turn factor * k now. Drops masks. Returns the factor.
  int refine_turns(int factor);

  /// Places each island, in order, at the lowest free place over its rotations, then the leftmost,
  /// on the first page that has one. Stops at the first island that has no place. Throws
  /// Error{cancelled}.
  PlacedIslands lay(const Arrangement& arrangement, const PageCells& sheet, Budget& budget);

  [[nodiscard]] std::size_t size() const { return outlines_.size(); }
  [[nodiscard]] int turns() const { return turns_; }
  [[nodiscard]] const Box& box(std::size_t island) const { return boxes_[island]; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Turn turn_of(std::size_t island, int turn) const;
  const Mask& mask_of(std::size_t island, int turn);

  /// The least columns of a page, of this ratio of height to width, on which every island fits
  /// alone. Throws Error{cancelled}.
  int least_side(const std::stop_token& stop, double ratio = 1);

 private:
  struct Page;
  /// The lowest free place of one rotation, if its top is below lowest_top.
  bool lower(std::size_t island, int turn, Page& page, CellPlace& spot, int& lowest_top);
  bool lay_one(std::size_t island, int turn, std::vector<Page>& pages, CellPlace& spot);

  std::span<const charts::Outline> outlines_;
  Rotation rotation_;
  int turns_;
  double scale_ = 0, padding_ = 0;
  std::vector<Box> boxes_;
  std::vector<std::optional<Mask>> masks_;
};

}  // namespace unwrapd::pack
