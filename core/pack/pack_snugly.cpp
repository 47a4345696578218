// Several rules are tried on a coarse grid, where one try shows how much of a page they fill; the
// best go on with a fine one, at scales at which their islands should just fit. How high a strip
// gets is partly chance, so scales are tried from both sides.
#include "core/pack/pack_snugly.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/pack/page_layout.hpp"
#include "core/pack/snug.hpp"
#include "core/solve/base/side_by_side.hpp"

namespace unwrapd {
namespace {

constexpr std::array kRules = {SnugRules{.2, .45}, SnugRules{.2, .3}, SnugRules{.05, .3},
                               SnugRules{.1, .6}};
/// How much is tried.
struct HowMuch {
  std::size_t rules = 0;  ///< on the coarse grid
  std::size_t fine = 0;   ///< rules that go on
  int scales = 0;         ///< of each
  double first = 1;       ///< of them, in shares of what the coarse grid suggests
};
constexpr HowMuch kUsualEffort{kRules.size(), 2, 3}, kOfVeryMany{1, 1, 1, 1.03};
constexpr std::size_t kVeryMany = 1000;
constexpr int kRoughCells = 512;
constexpr double kRoughPerIsland = 15;
constexpr double kSmaller = 0.9;  // where islands did not fit in at all
constexpr double kStep = 1.002;   // of the scale, beyond what seems to fit

struct Rated {
  SnugRules rules;
  double scale = 0;  ///< page sides a unit at which they should just fit
};

class SnugPacker {
 public:
  SnugPacker(const Arranger& arranger, const PageGrid& grid, Executor& executor)
      : arranger_(arranger),
        grid_(grid),
        executor_(executor),
        effort_(arranger.size() > kVeryMany ? kOfVeryMany : kUsualEffort) {}

  std::vector<Placement> packed() {
    auto rated = side_by_side<Rated>(effort_.rules, executor_,
                                     [&](std::size_t k) { return rate(kRules[k]); });
    std::ranges::stable_sort(rated, std::greater(), &Rated::scale);
    auto found = side_by_side<std::vector<Placement>>(
        effort_.fine, executor_, [&](std::size_t k) { return fitted(rated[k]); });
    return std::move(
        *std::ranges::max_element(found, {}, [](const auto& own) { return own.front().scale; }));
  }

 private:
  [[nodiscard]] int rough_side() const {
    return grid_.tight_side(cells_for(arranger_.size(), kRoughPerIsland, kRoughCells));
  }

  [[nodiscard]] Rated rate(const SnugRules& rules) const {
    const int side = rough_side();
    Arranger arranger = arranger_;
    for (double scale = usual_scale(arranger, grid_, 1, side);; scale *= kSmaller) {
      arranger.set_scale(scale, grid_.padding(side));
      const SnugPage page = laid_snugly(arranger, side, rules, executor_.stop());
      if (page.found.side > 0) return {rules, scale / side * std::sqrt(double(side) / page.height)};
    }
  }

  /// On the fine grid: the largest scale of some at which the strip is no higher than wide.
  [[nodiscard]] std::vector<Placement> fitted(const Rated& rated) const {
    const int side = grid_.tight_side(fine_cells(arranger_.size()));
    Arranger arranger = arranger_;
    std::vector<Placement> best;
    double scale = effort_.first * rated.scale * side, largest = 0, step = kStep;
    for (int tries = 0; tries < effort_.scales || best.empty(); ++tries) {
      arranger.set_scale(scale, grid_.padding(side));
      const SnugPage page = laid_snugly(arranger, side, rated.rules, executor_.stop());
      const bool fits = page.found.side == side;
      if (fits && scale > largest) {
        largest = scale;
        best = placements_of(page.found, arranger, grid_);
      }
      if (page.found.side == 0)
        scale *= kSmaller;
      else
        scale *= std::sqrt(double(side) / page.height) * (fits ? step : 1 / step);
      if (!fits) step *= kStep;
    }
    return best;
  }

  const Arranger& arranger_;
  const PageGrid& grid_;
  Executor& executor_;
  HowMuch effort_;
};

}  // namespace

std::vector<Placement> packed_snugly(const Arranger& arranger, const PageGrid& grid,
                                     Executor& executor) {
  return SnugPacker(arranger, grid, executor).packed();
}

}  // namespace unwrapd
