// The result of compaction depends on the first positions and on the rotations that are tried,
// partly by chance. So several starts are compacted on a coarse grid without padding, and the best
// continue on fine grids with padding.
#include "core/pack/pack_few.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/pack/page_layout.hpp"
#include "core/pack/touching_perimeter.hpp"
#include "core/solve/base/parallel_map.hpp"

namespace unwrapd::pack {
namespace {

struct Try {
  int turns = 0;  ///< rotations in a full circle
  TouchingRules rules;
};
/// Those of many rotations, whose masks take long, come last.
constexpr std::array kTries = {Try{72, {.2, .45}}, Try{48, {.1, .9}},  Try{60, {.2, .45}},
                               Try{48, {.4, .7}},  Try{96, {.2, .45}}, Try{72, {.4, .7}}};

/// Where rotations are fixed, tries differ by their rules alone.
constexpr std::array kFixedTries = {Try{1, {.2, .45}}, Try{1, {.1, .9}}, Try{1, {.4, .7}}};

/// How much is tried.
struct Extent {
  std::size_t starts = 0;    ///< of kTries
  std::size_t finished = 0;  ///< starts that continue on the fine grids
  double first = 1;          ///< work of the first compaction, in shares of the most
  double fine = 1;           ///< the same of those on the fine grids
  bool is_short = false;     ///< no grid between the first and the last
};
constexpr std::array kExtents = {Extent{2, 1, .05, .1}, Extent{4, 1, .1, .25}, Extent{6, 4, 1, 1}};

constexpr std::size_t kStartsWithSmall = 2;  // where there are more than kFewOnAPage
constexpr std::size_t kVeryFew = 3;  // islands that come to the same page from nearly any start

/// Very few islands of a small mesh would take longer to pack than to map; where they may turn,
/// most of that is masks. Where there are small ones besides the few, one start is nearly as good
/// as another.
Extent extent_of(std::size_t islands, Rotation rotation, Effort effort) {
  Extent extent = kExtents[static_cast<std::size_t>(effort)];
  if (islands > kFewOnAPage && effort == Effort::balanced) extent.starts = kStartsWithSmall;
  if (islands > kVeryFew || effort == Effort::best) return extent;
  extent.is_short = rotation == Rotation::any;
  extent.starts = extent.is_short ? 1 : std::min(extent.starts, islands);
  return extent;
}

struct Squeeze {
  CompactRules rules;     ///< for 1024 cells a side; the first grid's side is not scaled
  std::int64_t work = 0;  ///< words for each share
};
constexpr Squeeze kFirst{kFirstCompaction, 20'000'000};
constexpr std::array kGrids = {Squeeze{{512, 8, 2, 3}, 8'000'000},
                               Squeeze{{1024, 8, 1, 3}, 8'000'000}};
constexpr double kMostShares = 12;
constexpr double kSidesAShare = 30;  // of outlines, for one share: small shapes need no long search
constexpr int kFinerTurns = 4;       // for each of the coarse grid, on the fine ones
constexpr double kSmaller = 0.9;     // scale factor after islands did not fit

/// Islands on a page, and the placer that made their masks.
struct Attempt {
  std::optional<BottomLeftPlacer> placer = {};
  CellPacking found = {};
  [[nodiscard]] double density() const {  ///< pages a unit
    return found.side > 0 ? placer->scale() / found.side : 0;
  }
};

class FewPacker {
 public:
  FewPacker(std::span<const charts::Outline> islands, const PageGrid& grid, Rotation rotation,
            Effort effort, Executor& executor)
      : islands_(islands),
        grid_(grid),
        rotation_(rotation),
        extent_(extent_of(islands.size(), rotation, effort)),
        executor_(executor),
        shares_(shares_of(islands)) {}

  std::optional<std::vector<Placement>> packed() {
    const std::span<const Try> tries =
        rotation_ == Rotation::any ? std::span<const Try>(kTries) : kFixedTries;
    auto tried =
        solve::parallel_map<Attempt>(std::min(extent_.starts, tries.size()), executor_,
                                     [&](std::size_t k) { return compact_from(tries[k]); });
    std::ranges::stable_sort(tried, std::greater(), &Attempt::density);
    tried.resize(extent_.finished);
    tried = solve::parallel_map<Attempt>(
        extent_.finished, executor_, [&](std::size_t k) { return finish(std::move(tried[k])); });
    Attempt& best = *std::ranges::max_element(tried, {}, &Attempt::density);
    if (best.found.side == 0) return std::nullopt;
    return placements_of(best.found, *best.placer, grid_);
  }

 private:
  /// The same on the page's own shape.
  [[nodiscard]] Squeeze on_page(Squeeze squeeze, int side) const {
    squeeze.rules.side = side;
    squeeze.rules.ratio = grid_.ratio();
    return squeeze;
  }

  Attempt compact_from(const Try& own) const {
    Attempt tried{BottomLeftPlacer(islands_, own.turns, rotation_)};
    tried.found = start(*tried.placer, own.rules);
    const Squeeze first = on_page(kFirst, grid_.columns(kFirst.rules.side));
    const double scale = tried.placer->scale() * first.rules.side / tried.found.side;
    tried.found = compact_on(first, tried, scale);
    return tried;
  }

  /// Places twice, the second time at the scale at which the islands should just fit.
  CellPacking start(BottomLeftPlacer& placer, const TouchingRules& rules) const {
    const int side = grid_.columns(kFirst.rules.side);
    const double ratio = grid_.ratio();
    TouchingPage page;
    double scale = side * std::sqrt(kUsualFill * ratio / box_area(placer));
    for (; page.found.side == 0; scale *= kSmaller) {
      placer.set_scale(scale, 0);
      page = place_by_touching_perimeter(placer, side, rules, executor_.stop(), ratio);
    }
    const double first = placer.scale();
    placer.set_scale(first * std::sqrt(ratio * side / page.height), 0);
    const TouchingPage again =
        place_by_touching_perimeter(placer, side, rules, executor_.stop(), ratio);
    if (again.found.side > 0 && placer.scale() / again.found.side > first / page.found.side)
      return again.found;
    placer.set_scale(first, 0);
    return page.found;
  }

  Attempt finish(Attempt tried) const {
    turn_finely(tried);
    for (const Squeeze& grid :
         std::span(kGrids).subspan(extent_.is_short ? kGrids.size() - 1 : 0)) {
      if (tried.found.side == 0) return tried;
      const Squeeze own = on_page(grid, grid_.tight_side(grid_.columns(grid.rules.side)));
      const double scale = tried.placer->scale() * own.rules.side / tried.found.side;
      tried.found = compact_on(own, tried, scale);
    }
    return tried;
  }

  /// A step of a coarse grid moves the far end of a large island by many texels.
  static void turn_finely(Attempt& tried) {
    const int factor = tried.placer->refine_turns(kFinerTurns);
    for (CellPlace& spot : tried.found.spots) spot.turn *= factor;
    for (int& turn : tried.found.arrangement.turn) turn *= factor;
  }

  /// A page must not be larger than the one for which the padding was made; the islands shrink
  /// until that holds.
  CellPacking compact_on(const Squeeze& grid, Attempt& tried, double scale) const {
    const bool has_gaps = grid.rules.reach > 0;
    for (;;) {
      tried.placer->set_scale(scale, has_gaps ? grid_.padding(grid.rules.side) : 0);
      const double share = shares_ * (has_gaps ? extent_.fine : extent_.first);
      Budget budget{static_cast<std::int64_t>(share * static_cast<double>(grid.work)),
                    executor_.stop()};
      CellPacking found = compact(*tried.placer, tried.found, grid.rules, budget);
      if (!has_gaps || found.side <= grid.rules.side) return found;
      scale *= double(grid.rules.side) / found.side / kSpareSide;
    }
  }

  std::span<const charts::Outline> islands_;
  const PageGrid& grid_;
  Rotation rotation_;
  Extent extent_;
  Executor& executor_;
  double shares_;
};

}  // namespace

double shares_of(std::span<const charts::Outline> islands) {
  double sides = 0;
  for (const charts::Outline& island : islands) sides += static_cast<double>(island.size());
  return std::min({static_cast<double>(islands.size()), sides / kSidesAShare, kMostShares});
}

std::optional<std::vector<Placement>> pack_few(std::span<const charts::Outline> islands,
                                               const PageGrid& grid, Rotation rotation,
                                               Effort effort, Executor& executor) {
  return FewPacker(islands, grid, rotation, effort, executor).packed();
}

}  // namespace unwrapd::pack
