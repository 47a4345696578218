// Guided local search on overlaps: Egeblad, Nielsen, Odgaard, "Fast neighborhood search for two-
// and three-dimensional nesting problems", EJOR 2007, on cells.
//
// Placing islands one after another cannot close the gaps that the last ones leave. Here all
// islands lie on a page that is a little too small. Islands that overlap move, one at a time, to
// the place of least overlap. The weight of a pair grows while it overlaps, so that the search
// leaves local minima. The weighted overlap of an island at any place is a sum over its runs of
// differences in a table of the others' cells, summed up along rows.
#include "core/pack/compact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/splitmix64.hpp"
#include "core/pack/box.hpp"
#include "core/pack/page_grid.hpp"
#include "core/pack/row_prefix_sums.hpp"

namespace unwrapd::pack {
namespace {

constexpr int kLeastWeight = 16, kMostWeight = 1 << 14;
constexpr int kSweeps =
    60;  // passes over the overlapping islands, before a page counts as too small
constexpr int kColumnsAcross = 12;  // columns that are searched before the best is refined
constexpr int kAside = 8;           // columns searched on either side of the best
constexpr int kOtherTurns = 3;      // rotations tried beside the present one and its neighbours
constexpr int kWideningOfCompaction =
    128;  // share of a page by which it grows until islands do not overlap

struct Place {
  CellPlace spot;
  std::int32_t overlap = RowPrefixSums::kTooMuch;  ///< weighted
};

/// All islands on one page of a given size, which may overlap.
class Page {
 public:
  Page(BottomLeftPlacer& placer, Budget& budget, const CompactRules& rules)
      : placer_(placer),
        budget_(budget),
        rules_(rules),
        count_(placer.size()),
        weight_(count_ * count_, kLeastWeight),
        overlap_(count_ * count_, 0) {}

  /// Moves the islands into the page of `side` cells and apart; false if some still overlap.
  bool separate(std::vector<CellPlace>& spots, int side) {
    side_ = side;
    rows_ = rows_of(side, rules_.ratio);
    spots_ = spots;
    std::ranges::fill(weight_, kLeastWeight);
    for (std::size_t k = 0; k < count_; ++k)
      if (!pull_inside(k)) return false;
    for (int sweep = 0; sweep < kSweeps && budget_.words > 0; ++sweep) {
      throw_if_cancelled(budget_.stop);
      const std::vector<std::size_t> moving = overlapping();
      if (moving.empty()) {
        spots = spots_;
        return true;
      }
      for (const std::size_t k : moving) move(k);
      weigh();
    }
    return false;
  }

  /// Exchanges two islands, preferably large ones, and rotates one at random, to leave a local
  /// minimum.
  void exchange(std::vector<CellPlace>& spots) {
    std::vector<std::size_t> by_size(count_);
    std::iota(by_size.begin(), by_size.end(), 0);
    std::ranges::stable_sort(by_size, std::greater(),
                             [&](std::size_t k) { return size_rank(placer_.box(k).size.prod()); });
    const auto large = [&] {
      return by_size[std::min(sequence_.below(count_), sequence_.below(count_))];
    };
    CellPlace &a = spots[large()], &b = spots[large()];
    std::swap(a.x, b.x);
    std::swap(a.y, b.y);
    if (sequence_.below(2) == 0)
      a.turn = static_cast<int>(sequence_.below(static_cast<std::size_t>(placer_.turns())));
  }

 private:
  const Mask& mask(std::size_t k) { return placer_.mask_of(k, spots_[k].turn); }

  [[nodiscard]] bool has_room(const Mask& mask) const {
    return mask.width <= side_ && mask.touched.height() <= rows_;
  }

  bool pull_inside(std::size_t k) {
    CellPlace& spot = spots_[k];
    const int turns = placer_.turns();
    for (int t = 0; t < turns && !has_room(mask(k)); ++t) spot.turn = (spot.turn + 1) % turns;
    if (!has_room(mask(k))) return false;
    spot.x = std::min(spot.x, side_ - mask(k).width);
    spot.y = std::min(spot.y, rows_ - mask(k).touched.height());
    return true;
  }

  /// The number of cells of b on a or nearer to it than the padding.
  int overlap(std::size_t a, std::size_t b) {
    const Mask &own = mask(a), &other = mask(b);
    const CellPlace &at = spots_[a], &there = spots_[b];
    if (there.x >= at.x + own.width + own.margin || at.x - own.margin >= there.x + other.width)
      return 0;
    const int low = at.y - own.margin;
    const int first = std::max(low, there.y);
    const int last = std::min(low + own.grown.height(), there.y + other.touched.height());
    const int shift = there.x - (at.x - own.margin);
    int count = 0;
    for (int y = first; y < last; ++y)
      count += common_cells(own.grown.row(y - low), other.touched.row(y - there.y), shift);
    budget_.words -= std::max(0, last - first);
    return count;
  }

  /// The islands that overlap others, in an order that varies.
  std::vector<std::size_t> overlapping() {
    std::vector<char> moves(count_, 0);
    for (std::size_t a = 0; a < count_; ++a)
      for (std::size_t b = 0; b < a; ++b) {
        overlap_[a * count_ + b] = overlap(a, b);
        if (overlap_[a * count_ + b] > 0) moves[a] = moves[b] = 1;
      }
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < count_; ++k)
      if (moves[k] != 0) order.push_back(k);
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1], order[sequence_.below(k)]);
    return order;
  }

  /// Raises the weights of pairs by the overlaps at the start of the last sweep.
  void weigh() {
    int most = 1;
    for (const int cells : overlap_) most = std::max(most, cells);
    for (std::size_t a = 0; a < count_; ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const int cells = overlap_[a * count_ + b];
        int& weight = weight_[a * count_ + b];
        if (cells > 0)
          weight +=
              std::max(1, weight / 4) + static_cast<int>(std::int64_t{weight} * cells / most / 2);
        else
          weight -= weight / 16;
        weight = std::clamp(weight, kLeastWeight, kMostWeight);
        weight_[b * count_ + a] = weight;
      }
  }

  /// The possible positions of a mask's lower left cell.
  [[nodiscard]] CellWindow places(const Mask& mask, const CellPlace& from) const {
    const int reach = rules_.reach > 0 ? rules_.reach : std::max(side_, rows_);
    return {std::max(0, from.x - reach), std::min(side_ - mask.width, from.x + reach),
            std::max(0, from.y - reach), std::min(rows_ - mask.touched.height(), from.y + reach)};
  }

  /// Searches the places of a column from y_begin to y_last.
  void look(const Mask& mask, int turn, int x, int y_begin, int y_last, Place& best) {
    const LeastOverlap own = table_.least(mask, x, y_begin, y_last, best.overlap);
    if (own.weight < best.overlap) best = {{x, own.y, turn, 0}, own.weight};
  }

  /// Searches the best place of one rotation, first coarsely, then to the cell.
  void look_around(std::size_t k, int turn, Place& best) {
    const Mask& mask = placer_.mask_of(k, turn);
    if (!has_room(mask)) return;
    const CellWindow window = places(mask, spots_[k]);
    if (window.x_end < window.x_begin || window.y_end < window.y_begin) return;
    const int span = rules_.reach > 0 ? 2 * rules_.reach : side_;
    const int stride = std::max(1, span / kColumnsAcross);
    Place own{{}, best.overlap};
    const int offset = static_cast<int>(sequence_.below(static_cast<std::size_t>(stride)));
    for (int x = window.x_begin + offset; x <= window.x_end; x += stride)
      look(mask, turn, x, window.y_begin, window.y_end, own);
    if (own.overlap == best.overlap) return;
    refine(mask, window, stride, own);
    if (own.overlap < best.overlap) best = own;
  }

  void refine(const Mask& mask, const CellWindow& window, int stride, Place& best) {
    for (int step = (stride + 1) / 2;
         best.overlap > 0 && best.overlap != RowPrefixSums::kTooMuch;) {
      const Place before = best;
      for (const int x : {before.spot.x, before.spot.x - step, before.spot.x + step})
        if (window.x_begin <= x && x <= window.x_end)
          look(mask, before.spot.turn, x, std::max(window.y_begin, before.spot.y - kAside),
               std::min(window.y_end, before.spot.y + kAside - 1), best);
      if (best.overlap < before.overlap) continue;
      if (step == 1) return;
      step /= 2;
    }
  }

  /// Enters the weighted cells of the other islands into island k's table.
  void tabulate(std::size_t k) {
    table_.reset(window_of(k));
    for (std::size_t j = 0; j < count_; ++j)
      if (j != k) table_.take(mask(j).touched, spots_[j].x, spots_[j].y, weight_[k * count_ + j]);
    table_.sum_up();
  }

  void move(std::size_t k) {
    const std::int64_t before = table_.work();
    tabulate(k);
    const CellPlace& from = spots_[k];
    Place best{from};
    look(mask(k), from.turn, from.x, from.y, from.y, best);
    if (best.overlap > 0) find_better(k, best);
    spots_[k] = best.spot;
    budget_.words -= table_.work() - before;
  }

  void find_better(std::size_t k, Place& best) {
    const int turns = placer_.turns(), turn = spots_[k].turn;
    refine(mask(k), places(mask(k), spots_[k]), std::max(1, side_ / kColumnsAcross), best);
    look_around(k, turn, best);
    look_around(k, (turn + 1) % turns, best);
    look_around(k, (turn + turns - 1) % turns, best);
    for (int t = 0; rules_.reach == 0 && t < kOtherTurns; ++t)
      look_around(k, static_cast<int>(sequence_.below(static_cast<std::size_t>(turns))), best);
  }

  /// All cells that island k can come near to.
  CellWindow window_of(std::size_t k) {
    const int margin = mask(k).margin;
    if (rules_.reach == 0) return {-margin, side_ + margin, -margin, rows_ + margin};
    const int turns = placer_.turns(), turn = spots_[k].turn;
    int width = 0, height = 0;
    for (const int t : {turn, (turn + 1) % turns, (turn + turns - 1) % turns}) {
      const Mask& own = placer_.mask_of(k, t);
      width = std::max(width, own.width);
      height = std::max(height, own.touched.height());
    }
    const CellPlace& spot = spots_[k];
    return {std::max(0, spot.x - rules_.reach) - margin,
            std::min(side_, spot.x + rules_.reach + width) + margin,
            std::max(0, spot.y - rules_.reach) - margin,
            std::min(rows_, spot.y + rules_.reach + height) + margin};
  }

  BottomLeftPlacer& placer_;
  Budget& budget_;
  const CompactRules& rules_;
  std::size_t count_;
  int side_ = 0, rows_ = 0;
  std::vector<CellPlace> spots_;
  std::vector<int> weight_, overlap_;  ///< of pairs of islands
  RowPrefixSums table_;                ///< of all islands but the one that moves
  SplitMixSequence sequence_;
};

/// Scales positions from a page of one side to a page of another.
std::vector<CellPlace> scale_places(std::vector<CellPlace> spots, double ratio) {
  for (CellPlace& spot : spots) {
    spot.x = static_cast<int>(std::lround(spot.x * ratio));
    spot.y = static_cast<int>(std::lround(spot.y * ratio));
  }
  return spots;
}

}  // namespace

CellPacking compact(BottomLeftPlacer& placer, const CellPacking& from, const CompactRules& rules,
                    Budget& budget) {
  Page page(placer, budget, rules);
  int side = rules.side;
  std::vector<CellPlace> spots = scale_places(from.spots, double(side) / from.side);
  while (!page.separate(spots, side)) {
    if (budget.words <= 0) return {};
    side += 1 + side / kWideningOfCompaction;
    spots = scale_places(from.spots, double(side) / from.side);
  }
  CellPacking best{from.arrangement, spots, side, 1};
  for (int failures = 0;
       failures < rules.failures && budget.words > 0 && best.side > rules.enough;) {
    side = best.side - (failures == 0 ? rules.step : 1);
    if (page.separate(spots, side)) {
      best.spots = spots;
      best.side = side;
      failures = 0;
    } else {
      ++failures;
      spots = best.spots;
      if (rules.reach == 0) page.exchange(spots);
    }
  }
  for (std::size_t k = 0; k < best.spots.size(); ++k) best.arrangement.turn[k] = best.spots[k].turn;
  return best;
}

}  // namespace unwrapd::pack
