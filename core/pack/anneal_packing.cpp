// The islands keep their scale and the page shrinks. So every island is rasterized once, and one
// placement of all yields a figure, the height that they take in a strip as wide as the page,
// rather than a yes or no. If the strip is higher than wide, small changes of order and rotations
// are tried, and kept if the height does not grow by more than a threshold that falls to zero
// (Dueck, Scheuer 1990). Once the strip is a square, it gets narrower.
//
// Pages of a given size only tell yes or no. There, islands without a place move to the front of
// the order.
#include "core/pack/anneal_packing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

#include "core/base/splitmix64.hpp"
#include "core/pack/box.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {
namespace {

constexpr int kHeights = 4;     // maximal height of a strip, in widths
constexpr double kLift = 0.5;   // weight of the islands' mean height beside the strip's
constexpr int kWidening = 16;   // share of a strip's width by which it widens until islands fit in
constexpr int kBalancings = 4;  // steps towards a square
constexpr int kRetries = 12;    // with islands without a place moved to the front
constexpr double kDense = 0.95,
                 kLoose = 0.3;   // shares of pages that islands fill, at most and least
constexpr double kStep = 1.003;  // factor between page sides that are tried

/// A small change: exchanges two islands, moves one to the front, or rotates one.
void change(Arrangement& arrangement, int turns, SplitMixSequence& sequence) {
  const std::size_t n = arrangement.order.size();
  const std::size_t kind = sequence.below(10), a = sequence.below(n), b = sequence.below(n);
  auto& order = arrangement.order;
  const auto at = [&](std::size_t k) { return order.begin() + static_cast<std::ptrdiff_t>(k); };
  if (kind < 3) {
    std::swap(order[a], order[b]);
  } else if (kind < 6) {
    std::rotate(at(std::min(a, b)), at(std::max(a, b)), at(std::max(a, b) + 1));
  } else if (kind < 8) {
    arrangement.turn[a] = static_cast<int>(sequence.below(static_cast<std::size_t>(turns)));
  } else {
    const int step = sequence.below(2) == 0 ? 1 : turns - 1;
    arrangement.turn[a] = (std::max(arrangement.turn[a], 0) + step) % turns;
  }
}

void decide_turns(Arrangement& arrangement, const std::vector<CellPlace>& spots) {
  for (std::size_t k = 0; k < spots.size(); ++k) arrangement.turn[k] = spots[k].turn;
}

class AnnealedStrip {
 public:
  AnnealedStrip(BottomLeftPlacer& placer, Budget& budget, SplitMixSequence& sequence)
      : placer_(placer), budget_(budget), sequence_(sequence) {}

  CellPacking search(const Arrangement& start, const AnnealRules& rules) {
    least_ = placer_.least_side(budget_.stop);
    width_ = std::max(rules.width, least_);
    const auto words = static_cast<double>(budget_.words);
    now_ = start;
    for (lay_again(width_); best_.side == 0;) lay_again(width_ + 1 + width_ / kWidening);
    balance();
    while (budget_.words > 0 && best_.side > rules.enough && narrow()) {
      Arrangement next = now_;
      for (std::size_t k = 0; k <= sequence_.below(2); ++k)
        change(next, placer_.turns(), sequence_);
      try_it(next, rules.heat * width_ * static_cast<double>(budget_.words) / words);
    }
    return std::move(best_);
  }

 private:
  /// Accepts the arrangement if it raises the strip by at most `rise`.
  bool try_it(const Arrangement& arrangement, double rise) {
    const int limit = top_ > 0 ? static_cast<int>(height_ + rise) : kHeights * width_;
    const PlacedIslands laid = placer_.lay(arrangement, {width_, limit, 1}, budget_);
    if (!laid.is_complete) return false;
    const double height = laid.top + kLift * laid.mean_height;
    if (top_ > 0 && height > height_ + rise) return false;
    now_ = arrangement;
    decide_turns(now_, laid.spots);
    top_ = laid.top;
    height_ = height;
    const int side = std::max(width_, top_);
    if (best_.side == 0 || side < best_.side) best_ = {now_, laid.spots, side, 1};
    return true;
  }

  /// Chooses another rotation for islands that are too wide.
  bool lay_again(int width) {
    width_ = width;
    top_ = 0;
    Arrangement next = now_;
    for (std::size_t k = 0; k < next.turn.size(); ++k)
      if (next.turn[k] != kAnyTurn && placer_.mask_of(k, next.turn[k]).width > width)
        next.turn[k] = kAnyTurn;
    return try_it(next, 0);
  }

  /// Adjusts the width until the first packing is as high as wide.
  void balance() {
    for (int k = 0; k < kBalancings && best_.side > 0 && top_ != width_; ++k)
      if (!lay_again(std::max(least_, (width_ + top_ + 1) / 2))) break;
    if (best_.side == 0) return;
    now_ = best_.arrangement;
    lay_again(std::max(least_, best_.side - 1));
  }

  /// Narrows the strip as long as it is no higher than wide; false if it cannot be narrowed.
  bool narrow() {
    while (top_ > 0 && top_ <= width_) {
      if (width_ <= least_) return false;
      lay_again(std::max(least_, width_ - std::max(1, (width_ - top_ + 1) / 2)));
    }
    return top_ > 0;
  }

  BottomLeftPlacer& placer_;
  Budget& budget_;
  SplitMixSequence& sequence_;
  int least_ = 1, width_ = 1;
  int top_ = 0;        ///< of the strip as it is; 0: empty
  double height_ = 0;  ///< its top, plus a small share of its islands' mean height
  Arrangement now_;
  CellPacking best_;
};

/// Places all again, with the first island that found no place at the front.
CellPacking with_retries(BottomLeftPlacer& placer, Arrangement arrangement, const PageCells& sheet,
                         Budget& budget) {
  for (int k = 0; k < kRetries; ++k) {
    const PlacedIslands laid = placer.lay(arrangement, sheet, budget);
    if (laid.is_complete) {
      decide_turns(arrangement, laid.spots);
      return {std::move(arrangement), laid.spots, sheet.width, laid.pages};
    }
    const auto begin = arrangement.order.begin(), at = begin + laid.placed;
    if (at == begin) break;
    std::rotate(begin, at, at + 1);
  }
  return {};
}

double area_in_cells(const BottomLeftPlacer& placer) {
  double area = 0;
  for (std::size_t k = 0; k < placer.size(); ++k) {
    const Vec2 size = placer.scale() * placer.box(k).size;
    area += (size.x() + 1) * (size.y() + 1);
  }
  return area;
}

}  // namespace

std::vector<Arrangement> usual_arrangements(const BottomLeftPlacer& placer) {
  using Measure = double (*)(const Vec2&);
  constexpr std::array<Measure, 4> measures = {
      [](const Vec2& size) { return size.maxCoeff(); },
      [](const Vec2& size) { return size.x() * size.y(); },
      [](const Vec2& size) { return size.minCoeff(); },
      [](const Vec2& size) { return size.sum(); },
  };
  std::vector<Arrangement> all;
  for (const Measure measure : measures) {
    Arrangement arrangement{std::vector<Index>(placer.size()),
                            std::vector<int>(placer.size(), kAnyTurn)};
    std::iota(arrangement.order.begin(), arrangement.order.end(), 0);
    const auto size = [&](Index k) {
      return size_rank(measure(placer.box(static_cast<std::size_t>(k)).size));
    };
    std::stable_sort(arrangement.order.begin(), arrangement.order.end(),
                     [&](Index a, Index b) { return size(a) > size(b); });
    all.push_back(std::move(arrangement));
  }
  return all;
}

std::vector<CellPacking> smallest_page(BottomLeftPlacer& placer,
                                       const std::vector<Arrangement>& starts,
                                       const AnnealRules& rules, Budget& budget) {
  std::vector<CellPacking> all;
  SplitMixSequence sequence;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    Budget own{budget.words / static_cast<std::int64_t>(starts.size() - k), budget.stop};
    budget.words -= own.words;
    all.push_back(AnnealedStrip(placer, own, sequence).search(starts[k], rules));
    budget.words += std::min<std::int64_t>(own.words, 0);
    if (all.back().side <= rules.enough) break;
  }
  std::ranges::stable_sort(all, std::less(), &CellPacking::side);
  return all;
}

CellPacking smallest_pages(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                           const PagesWanted& pages, Budget& budget) {
  const auto sheet = [&](int side) {
    return PageCells{side, rows_of(side, pages.ratio), pages.count};
  };
  const double area = area_in_cells(placer) / (pages.count * pages.ratio);
  const double least = std::max<double>(placer.least_side(budget.stop, pages.ratio),
                                        std::sqrt(kLoose * area / kDense));
  CellPacking best;
  double low = least, high = std::max(least, std::sqrt(area / kLoose)) + 1;
  for (double side = high; best.side == 0; side *= 2)
    best = fewest_pages(placer, starts, sheet(int(side)), budget);
  for (high = best.side; high > low * kStep && high - low > 1;) {
    const int side = static_cast<int>((low + high) / 2);
    CellPacking found = fewest_pages(placer, starts, sheet(side), budget);
    (found.side > 0 ? high : low) = side;
    if (found.side > 0) best = std::move(found);
  }
  return best;
}

CellPacking fewest_pages(BottomLeftPlacer& placer, const std::vector<Arrangement>& starts,
                         const PageCells& sheet, Budget& budget) {
  CellPacking best;
  for (const Arrangement& start : starts) {
    CellPacking found = with_retries(placer, start, sheet, budget);
    if (found.side == 0) continue;
    if (best.side == 0 || found.pages < best.pages) best = std::move(found);
    if (best.pages == 1 || budget.words <= 0) break;
  }
  return best;
}

}  // namespace unwrapd::pack
