// Several rules are tried on a coarse grid, where one attempt shows how much of a page they fill.
// The best continue on a fine grid, at scales at which the islands should just fit. The height of a
// strip is partly chance, so scales are tried from both sides.
#include "core/pack/pack_many.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/pack/page_layout.hpp"
#include "core/pack/touching_perimeter.hpp"
#include "core/solve/base/parallel_map.hpp"

namespace unwrapd::pack {
namespace {

constexpr std::array kRules = {TouchingRules{.2, .45}, TouchingRules{.2, .3},
                               TouchingRules{.05, .3}, TouchingRules{.1, .6}};
/// The extent of the search.
struct SearchExtent {
  std::size_t rules = 0;  ///< on the coarse grid
  std::size_t fine = 0;   ///< rules that continue
  int scales = 0;         ///< for each rule
  double first = 1;       ///< the first scale, relative to the one that the coarse grid suggests
};
constexpr std::array kExtentsOfMany = {SearchExtent{1, 1, 2}, SearchExtent{kRules.size(), 1, 2},
                                       SearchExtent{kRules.size(), 2, 3}};
constexpr SearchExtent kOfVeryMany{1, 1, 1, 1.03};
constexpr std::size_t kVeryMany = 1000;
constexpr int kRoughCells = 512;
constexpr double kRoughPerIsland = 15;
constexpr double kSmallerTrial = 0.9;  // scale factor after islands did not fit at all
constexpr double kTrialStep = 1.002;   // factor of the scale, beyond the one that seems to fit

struct RatedRules {
  TouchingRules rules;
  double scale = 0;  ///< page sides a unit at which they should just fit
};

class SnugPacker {
 public:
  SnugPacker(const BottomLeftPlacer& placer, const PageGrid& grid, Effort effort,
             Executor& executor)
      : placer_(placer),
        grid_(grid),
        executor_(executor),
        extent_(placer.size() > kVeryMany ? kOfVeryMany
                                          : kExtentsOfMany[static_cast<std::size_t>(effort)]) {}

  std::vector<Placement> packed() {
    auto rated = solve::parallel_map<RatedRules>(extent_.rules, executor_,
                                                 [&](std::size_t k) { return rate(kRules[k]); });
    std::ranges::stable_sort(rated, std::greater(), &RatedRules::scale);
    auto found = solve::parallel_map<std::vector<Placement>>(
        extent_.fine, executor_, [&](std::size_t k) { return largest_fit(rated[k]); });
    return std::move(
        *std::ranges::max_element(found, {}, [](const auto& own) { return own.front().scale; }));
  }

 private:
  [[nodiscard]] int rough_side() const {
    return grid_.tight_side(grid_.columns(cells_for(placer_.size(), kRoughPerIsland, kRoughCells)));
  }

  /// The factor of the scale at which a strip would be as high as the page.
  [[nodiscard]] double to_page(int side, const TouchingPage& page) const {
    return std::sqrt(grid_.ratio() * side / page.height);
  }

  [[nodiscard]] RatedRules rate(const TouchingRules& rules) const {
    const int side = rough_side();
    BottomLeftPlacer placer = placer_;
    for (double scale = usual_scale(placer, grid_, 1, side);; scale *= kSmallerTrial) {
      placer.set_scale(scale, grid_.padding(side));
      const TouchingPage page =
          place_by_touching_perimeter(placer, side, rules, executor_.stop(), grid_.ratio());
      if (page.found.side > 0) return {rules, scale / side * to_page(side, page)};
    }
  }

  /// On the fine grid: the largest scale tried at which the strip is no higher than wide.
  [[nodiscard]] std::vector<Placement> largest_fit(const RatedRules& rated) const {
    const int side = grid_.tight_side(grid_.columns(fine_cells(placer_.size())));
    BottomLeftPlacer placer = placer_;
    std::vector<Placement> best;
    double scale = extent_.first * rated.scale * side, largest = 0, step = kTrialStep;
    for (int tries = 0; tries < extent_.scales || best.empty(); ++tries) {
      placer.set_scale(scale, grid_.padding(side));
      const TouchingPage page =
          place_by_touching_perimeter(placer, side, rated.rules, executor_.stop(), grid_.ratio());
      const bool fits = page.found.side == side;
      if (fits && scale > largest) {
        largest = scale;
        best = placements_of(page.found, placer, grid_);
      }
      if (page.found.side == 0)
        scale *= kSmallerTrial;
      else
        scale *= to_page(side, page) * (fits ? step : 1 / step);
      if (!fits) step *= kTrialStep;
    }
    return best;
  }

  const BottomLeftPlacer& placer_;
  const PageGrid& grid_;
  Executor& executor_;
  SearchExtent extent_;
};

}  // namespace

std::vector<Placement> pack_many(const BottomLeftPlacer& placer, const PageGrid& grid,
                                 Effort effort, Executor& executor) {
  return SnugPacker(placer, grid, effort, executor).packed();
}

}  // namespace unwrapd::pack
