// The touching perimeter rule of Lodi, Martello, Vigo ("Heuristic and metaheuristic approaches for
// a class of two-dimensional bin packing problems", INFORMS Journal on Computing 11, 1999), for
// cells, and with a choice among islands. With a fixed order, an island takes the first hollow that
// it fits into, however badly; here each hollow gets the island that fills it best.
//
// An island's lowest place only moves up as the strip fills, and only changes if an island was
// placed beside it. So places are cached from step to step.
#include "core/pack/touching_perimeter.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "core/base/cancel.hpp"
#include "core/pack/page_grid.hpp"
#include "core/pack/placement_hints.hpp"

namespace unwrapd::pack {
namespace {

constexpr int kTouch = 3;  // cells beyond the padding: nearer islands touch
constexpr double kChoice = 100, kChoices = 40'000;  // islands to choose from; choices in all
constexpr double kHighest = 1.5;                    // in heights of the page

/// Appends the cells of a run that no run of another row covers, at height y.
void add_bare(const Run& run, std::span<const Run> other, int y, std::vector<Cell>& cells) {
  int x = run.begin;
  for (const Run& cover : other) {
    if (cover.begin >= run.end) break;
    for (; x < cover.begin; ++x) cells.push_back({x, y});
    x = std::max(x, cover.end);
  }
  for (; x < run.end; ++x) cells.push_back({x, y});
}

/// The cells around an island, relative to its lower left one, in which others touch it.
std::vector<Cell> feelers_of(const Mask& mask) {
  const int away = mask.margin + kTouch, height = mask.touched.height();
  const auto row_at = [&](int y) {
    return y < 0 || y >= height ? std::span<const Run>() : mask.touched.row(y);
  };
  std::vector<Cell> feelers;
  for (int y = 0; y < height; ++y)
    for (const Run& run : mask.touched.row(y)) {
      feelers.push_back({run.begin - away, y});
      feelers.push_back({run.end - 1 + away, y});
      add_bare(run, row_at(y - 1), y - away, feelers);
      add_bare(run, row_at(y + 1), y + away, feelers);
    }
  return feelers;
}

/// An island with one rotation, and its place.
struct Candidate {
  Cell at = {};
  double contact = 0;     ///< share of the cells around it that touch
  bool is_known = false;  ///< false: `at` is only a lower bound of its place
  bool has_place = true;
  std::vector<Cell> feelers = {};
};

class Snug {
 public:
  Snug(BottomLeftPlacer& placer, int width, const TouchingRules& rules, const std::stop_token& stop,
       double ratio)
      : placer_(placer),
        rules_(rules),
        stop_(stop),
        ratio_(ratio),
        turns_(static_cast<std::size_t>(placer.turns())),
        margin_(placer.mask_of(0, 0).margin),
        page_(width, static_cast<int>(kHighest * ratio * width), margin_, longest_run(width)),
        candidates_(placer.size() * turns_) {}

  TouchingPage run() {
    const std::size_t count = placer_.size();
    const double wanted = kChoices / static_cast<double>(count);
    const auto choice = static_cast<std::size_t>(std::clamp(wanted, 1.0, kChoice));
    std::vector<std::size_t> rest = by_size();
    TouchingPage laid;
    laid.found.arrangement.turn.assign(count, 0);
    laid.found.spots.resize(count);
    while (!rest.empty()) {
      const auto choices = std::span(rest).first(std::min(choice, rest.size()));
      const std::optional<std::size_t> best = best_of(choices);
      if (!best) return {};
      set_down(*best, laid);
      forget_around(*best, choices);
      rest.erase(std::ranges::find(rest, *best / turns_));
    }
    laid.found.side = std::max(page_.width(), columns_for(laid.height, ratio_));
    return laid;
  }

 private:
  const Mask& mask(std::size_t candidate) {
    return placer_.mask_of(candidate / turns_, static_cast<int>(candidate % turns_));
  }

  int longest_run(int width) {
    double longest = 1;
    for (std::size_t k = 0; k < placer_.size(); ++k)
      longest = std::max(longest, placer_.box(k).size.norm() * placer_.scale());
    return static_cast<int>(std::min<double>(longest + 2, width)) + 2 * margin_;
  }

  /// The islands in descending size, and their mean size.
  std::vector<std::size_t> by_size() {
    std::vector<std::size_t> order(placer_.size());
    std::iota(order.begin(), order.end(), 0);
    size_.resize(order.size());
    double all = 0;
    for (const std::size_t k : order) {
      throw_if_cancelled(stop_);
      all += placer_.mask_of(k, 0).cells;
    }
    mean_ = std::sqrt(std::max(1.0, all) / static_cast<double>(order.size()));
    for (const std::size_t k : order) size_[k] = std::sqrt(placer_.mask_of(k, 0).cells) / mean_;
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t k) { return size_[k]; });
    return order;
  }

  std::optional<std::size_t> best_of(std::span<const std::size_t> islands) {
    std::optional<std::size_t> best;
    double most = -std::numeric_limits<double>::infinity();
    for (const std::size_t island : islands) {
      throw_if_cancelled(stop_);
      for (std::size_t k = island * turns_; k < (island + 1) * turns_; ++k) {
        Candidate& own = candidates_[k];
        if (!own.is_known && own.has_place) look(k);
        if (!own.has_place) continue;
        const double middle = own.at.y + mask(k).touched.height() / 2.0;
        const double worth =
            own.contact - rules_.low * middle / mean_ + rules_.large * size_[island];
        if (worth > most) most = worth, best = k;
      }
    }
    return best;
  }

  /// Finds the lowest free place, and the contact there.
  void look(std::size_t k) {
    Candidate& own = candidates_[k];
    const Mask& shape = mask(k);
    if (own.feelers.empty()) {
      own.feelers = feelers_of(shape);
      if (placer_.size() > static_cast<std::size_t>(kChoices / kChoice)) own.at = lowest_.of(shape);
    }
    std::optional<int> x = page_.first_free(shape, own.at.y, own.at.x);
    while (!x && own.at.y + shape.touched.height() < page_.height())
      x = page_.first_free(shape, ++own.at.y);
    own.has_place = x.has_value();
    own.is_known = true;
    if (!x) return;
    own.at.x = *x;
    const auto touches = [&](const Cell& cell) {
      return page_.is_taken(own.at.x + cell.x, own.at.y + cell.y);
    };
    own.contact = static_cast<double>(std::ranges::count_if(own.feelers, touches)) /
                  static_cast<double>(own.feelers.size());
  }

  void set_down(std::size_t k, TouchingPage& laid) {
    const Mask& shape = mask(k);
    const Candidate& own = candidates_[k];
    const auto turn = static_cast<int>(k % turns_);
    page_.stamp(shape, own.at.x, own.at.y);
    lowest_.of(shape) = own.at;
    laid.found.arrangement.order.push_back(static_cast<Index>(k / turns_));
    laid.found.arrangement.turn[k / turns_] = turn;
    laid.found.spots[k / turns_] = {own.at.x, own.at.y, turn, 0};
    laid.height = std::max(laid.height, own.at.y + shape.touched.height());
  }

  /// Invalidates the candidates that touch or overlap the placed island.
  void forget_around(std::size_t laid, std::span<const std::size_t> islands) {
    const int away = margin_ + kTouch;
    const Cell low = candidates_[laid].at;
    const Cell high{low.x + mask(laid).width, low.y + mask(laid).touched.height()};
    for (const std::size_t island : islands)
      for (std::size_t k = island * turns_; k < (island + 1) * turns_; ++k) {
        Candidate& own = candidates_[k];
        if (own.at.x < high.x + away && low.x < own.at.x + mask(k).width + away &&
            own.at.y < high.y + away && low.y < own.at.y + mask(k).touched.height() + away)
          own.is_known = false;
        if (island == laid / turns_) std::vector<Cell>().swap(own.feelers);
      }
  }

  BottomLeftPlacer& placer_;
  TouchingRules rules_;
  const std::stop_token& stop_;
  double ratio_;  ///< of the page's height to its width
  std::size_t turns_;
  int margin_;
  Occupancy page_;
  PlacementHints lowest_;
  std::vector<Candidate> candidates_;  ///< [island * turns + turn]
  std::vector<double> size_;           ///< [island], in sides of the mean one
  double mean_ = 1;                    ///< cells: the side of a square as large as the mean island
};

}  // namespace

TouchingPage place_by_touching_perimeter(BottomLeftPlacer& placer, int width,
                                         const TouchingRules& rules, const std::stop_token& stop,
                                         double ratio) {
  return Snug(placer, width, rules, stop, ratio).run();
}

}  // namespace unwrapd::pack
