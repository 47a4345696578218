// Bottom-left placement (Baker, Coffman, Rivest 1980) of cell masks: the lowest row that has a free
// place, in it the leftmost. Rows are searched from below, so that islands fill holes that they fit
// into. With many islands a size class starts at the row of its last island, since the rows below
// had no place for one of that size.
#include "core/pack/bottom_left.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/cancel.hpp"
#include "core/pack/page_grid.hpp"
#include "core/pack/placement_hints.hpp"

namespace unwrapd::pack {
namespace {

constexpr std::size_t kFewIslands = 64;  // up to which every row is searched
constexpr double kSpanning = 0.5;        // the square of an island's length that may span a page,
                                         // beside the area of all boxes

int allowed_turns(int turns, Rotation rotation) {
  if (rotation == Rotation::any) return turns;
  return rotation == Rotation::quarter ? 4 : 1;
}

}  // namespace

/// A page and its free cells.
struct BottomLeftPlacer::Page {
  Occupancy cells;
  PlacementHints lowest = {};
};

BottomLeftPlacer::BottomLeftPlacer(std::span<const charts::Outline> outlines, int turns,
                                   Rotation rotation)
    : outlines_(outlines), rotation_(rotation), turns_(allowed_turns(turns, rotation)) {
  boxes_.reserve(outlines.size());
  for (const charts::Outline& outline : outlines) boxes_.push_back(resting_box(outline, rotation));
  if (rotation != Rotation::any) return;
  double area = 0;
  for (const Box& box : boxes_) area += box.size.prod();
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const double length = boxes_[k].size.maxCoeff();
    if (length * length > kSpanning * area)
      boxes_[k] = squarest_box(charts::points_of(outlines[k]));
  }
}

void BottomLeftPlacer::set_scale(double cells_per_unit, double padding) {
  scale_ = cells_per_unit;
  padding_ = padding;
  masks_.assign(outlines_.size() * static_cast<std::size_t>(turns_), std::nullopt);
}

int BottomLeftPlacer::refine_turns(int factor) {
  if (rotation_ != Rotation::any) return 1;
  turns_ *= factor;
  set_scale(scale_, padding_);
  return factor;
}

Turn BottomLeftPlacer::turn_of(std::size_t island, int turn) const {
  const Box& box = boxes_[island];
  const double angle = 2 * std::numbers::pi * turn / turns_ + std::atan2(box.sine, box.cosine);
  return {std::cos(angle), std::sin(angle), scale_};
}

const Mask& BottomLeftPlacer::mask_of(std::size_t island, int turn) {
  auto& mask = masks_[island * static_cast<std::size_t>(turns_) + static_cast<std::size_t>(turn)];
  if (!mask) mask = make_mask(outlines_[island], turn_of(island, turn), padding_);
  return *mask;
}

int BottomLeftPlacer::least_side(const std::stop_token& stop, double ratio) {
  int side = 1;
  for (std::size_t k = 0; k < size(); ++k) {
    throw_if_cancelled(stop);
    int own = std::numeric_limits<int>::max();
    for (int turn = 0; turn < turns_; ++turn) {
      const Mask& mask = mask_of(k, turn);
      own = std::min(own, std::max(mask.width, columns_for(mask.touched.height(), ratio)));
    }
    side = std::max(side, own);
  }
  return side;
}

bool BottomLeftPlacer::lower(std::size_t island, int turn, Page& page, CellPlace& spot,
                             int& lowest_top) {
  const Mask& mask = mask_of(island, turn);
  const bool few = size() <= kFewIslands;
  Cell from = few ? Cell() : page.lowest.of(mask);
  for (; from.y + mask.touched.height() < lowest_top; from = {0, from.y + 1}) {
    const std::optional<int> x = page.cells.first_free(mask, from.y, from.x);
    if (!x) continue;
    lowest_top = from.y + mask.touched.height();
    spot = {*x, from.y, turn, spot.page};
    if (!few) page.lowest.of(mask) = {*x, from.y};
    return true;
  }
  return false;
}

bool BottomLeftPlacer::lay_one(std::size_t island, int turn, std::vector<Page>& pages,
                               CellPlace& spot) {
  const int first = turn == kAnyTurn ? 0 : turn, last = turn == kAnyTurn ? turns_ - 1 : turn;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    spot.page = static_cast<int>(p);
    int lowest_top = pages[p].cells.height() + 1;
    bool found = false;
    for (int t = first; t <= last; ++t) found |= lower(island, t, pages[p], spot, lowest_top);
    if (!found) continue;
    pages[p].cells.stamp(mask_of(island, spot.turn), spot.x, spot.y);
    return true;
  }
  return false;
}

PlacedIslands BottomLeftPlacer::lay(const Arrangement& arrangement, const PageCells& sheet,
                                    Budget& budget) {
  const int margin = margin_of(padding_);
  double longest = 1;
  for (const Box& box : boxes_) longest = std::max(longest, box.size.norm() * scale_);
  const int run = static_cast<int>(std::min<double>(longest + 2, sheet.width)) + 2 * margin;
  std::vector<Page> pages;
  const auto add_page = [&] {
    const auto number = static_cast<int>(pages.size());
    pages.push_back({Occupancy(sheet.width, sheet.height, margin, run)});
    for (const TakenCells& own : sheet.taken)
      if (own.page == number) pages.back().cells.stamp(own.mask, own.x, own.y);
  };
  add_page();
  PlacedIslands laid{.spots = std::vector<CellPlace>(size())};
  double cells = 0;
  for (const Index k : arrangement.order) {
    throw_if_cancelled(budget.stop);
    const auto island = static_cast<std::size_t>(k);
    const std::int64_t before = pages.back().cells.work();
    CellPlace& spot = laid.spots[island];
    bool found = lay_one(island, arrangement.turn[island], pages, spot);
    if (!found && static_cast<int>(pages.size()) < sheet.pages) {
      add_page();
      found = lay_one(island, arrangement.turn[island], pages, spot);
    }
    budget.words -= std::max<std::int64_t>(0, pages.back().cells.work() - before);
    if (!found) return laid;
    ++laid.placed;
    const Mask& mask = mask_of(island, spot.turn);
    const int top = spot.y + mask.touched.height();
    laid.mean_height += mask.cells * (spot.y + mask.touched.height() / 2.0);
    cells += mask.cells;
    if (spot.page == 0) laid.top = std::max(laid.top, top);
    laid.pages = std::max(laid.pages, spot.page + 1);
  }
  laid.mean_height /= std::max(cells, 1.0);
  laid.is_complete = true;
  return laid;
}

}  // namespace unwrapd::pack
