// One page: few islands are compacted (pack_few), many are placed by touching perimeter
// (pack_many), or around the few that are large (pack_large_first). Several pages, or a given
// density: a search over orders and rotations on coarse grids, where it is cheap, then placement on
// a fine one. Islands keep their scale and the page shrinks; the cells' size in texels, and with it
// the padding in cells, follows from its side.
#include "core/pack/pack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.hpp"
#include "core/pack/anneal_packing.hpp"
#include "core/pack/box.hpp"
#include "core/pack/compact.hpp"
#include "core/pack/pack_few.hpp"
#include "core/pack/pack_large_first.hpp"
#include "core/pack/pack_many.hpp"
#include "core/pack/pack_stacked.hpp"
#include "core/pack/page_grid.hpp"
#include "core/pack/page_layout.hpp"

namespace unwrapd::pack {
namespace {

/// A grid on which several pages are searched; the coarse one first.
struct Level {
  int cells = 0;          ///< least cells a side
  double per_island = 0;  ///< cells along a side for each island
  double work = 0;        ///< words for each share
};
constexpr std::array kLevels = {Level{96, 12, 18e6}, Level{160, 20, 6e6}};
constexpr Level kRough = {96, 12, 350e3};  // for rough_fill()
constexpr double kRoughHeat = 0.1;
constexpr double kRoughSqueezeWork = 1e6, kFineWork = 1e6;  // words for each share
constexpr std::size_t kSearched = 400;    // islands; more are not searched on a coarse grid
constexpr std::size_t kMostApart = 5000;  // islands; more are packed in rows, on one page

int turns_for(std::size_t islands) {
  if (islands <= kFewOnAPage) return 48;
  return islands <= 100 ? 8 : 4;
}

class Packer {
 public:
  Packer(std::span<const charts::Outline> outlines, const PageOptions& page, Executor& executor)
      : outlines_(outlines),
        placer_(outlines, turns_for(outlines.size()), page.packing.rotation),
        shares_(shares_of(outlines)),
        page_(page),
        padding_(kept_padding(page, outlines.size())),
        grid_{padding_ / page.resolution, page.aspect()},
        executor_(executor),
        stop_(executor.stop()) {}

  /// Packs the islands as large as they fit on the allowed pages.
  PackResult largest() {
    if (page_.packing.max_pages > 1) return on_several();
    const bool are_few_large = count_large(outlines_) <= kFewOnAPage;
    if (are_few_large && placer_.size() <= kFewWithSmall) {
      auto few = pack_few(outlines_, grid_, page_.packing.rotation, page_.effort, executor_);
      if (few) return {std::move(*few), 1, padding_, {}};
    }
    std::vector<Placement> best = pack_many(placer_, grid_, page_.effort, executor_);
    if (are_few_large && padding_ == page_.padding) {
      auto around = pack_large_first(outlines_, page_, executor_);
      if (around && around->front().scale > best.front().scale) best = std::move(*around);
    }
    return {std::move(best), 1, padding_, {}};
  }

  /// The share of the page that a short search on coarse grids fills. area: of all islands.
  double rough_fill(double area, const RoughRules& rules_of_search) {
    const std::size_t n = placer_.size();
    const int side = cells_for(n, kRough.per_island, kRough.cells);
    double scale = side * std::sqrt(kUsualFill / box_area(placer_));
    std::vector<Arrangement> starts = usual_arrangements(placer_);
    if (n > kSearched) starts.resize(1);
    const double tightest =
        std::sqrt(area / rules_of_search.enough);  // page side, in the islands' units
    const AnnealRules strip{side, kRoughHeat, static_cast<int>(scale * tightest)};
    placer_.set_scale(scale, 0);
    Budget budget{work(rules_of_search.work * kRough.work), stop_};
    CellPacking found = smallest_page(placer_, starts, strip, budget).front();
    if (n <= kFewOnAPage && found.side > strip.enough) {
      CompactRules rules = kFirstCompaction;
      const double ratio = double(rules.side) / found.side;
      rules.enough = static_cast<int>(scale * ratio * tightest);
      placer_.set_scale(scale * ratio, 0);
      budget = {work(rules_of_search.work * kRoughSqueezeWork), stop_};
      const CellPacking tight = compact(placer_, found, rules, budget);
      if (tight.side > 0) scale *= ratio, found = tight;
    }
    return area * scale * scale / (double(found.side) * found.side);
  }

  /// Packs at the given density, on as few pages as possible.
  PackResult at_density(double texels_per_unit) {
    const int side = fine_side();
    const double page_per_unit = texels_per_unit / page_.resolution;
    if (is_too_large(page_per_unit))
      refuse(
          "An island at this density is larger than a page; lower texels_per_unit, or ask for a "
          "larger page.");
    placer_.set_scale(page_per_unit / grid_.cell(side), grid_.padding(side));
    Budget budget{work(kFineWork), stop_};
    const CellPacking found =
        fewest_pages(placer_, usual_arrangements(placer_),
                     {side, rows_of(side, grid_.ratio()), page_.packing.max_pages}, budget);
    if (found.side == 0)
      refuse(page_.packing.group == PageGroup::scene
                 ? "The islands at this density do not fit on the pages; raise max_pages, ask for "
                   "larger pages, or lower texels_per_unit."
                 : "The islands of a group at this density do not fit on its page; ask for larger "
                   "pages, or lower texels_per_unit.");
    return to_result(found);
  }

 private:
  [[noreturn]] static void refuse(const std::string& message) {
    throw Error(ErrorCode::does_not_fit, message, "/texels_per_unit");
  }

  /// Columns of the final grid.
  [[nodiscard]] int fine_side() const {
    return grid_.tight_side(grid_.columns(fine_cells(placer_.size())));
  }

  /// Tested before any island is rasterized, which would need too many cells. The smallest box
  /// contains a square of its shorter side; an island cannot fit if that square does not.
  [[nodiscard]] bool is_too_large(double page_per_unit) const {
    for (std::size_t k = 0; k < placer_.size(); ++k) {
      const Vec2 size = page_per_unit * least_box(k);
      if (size.minCoeff() > std::min(1.0, grid_.aspect) ||
          size.maxCoeff() > std::sqrt(1 + grid_.aspect * grid_.aspect))
        return true;
    }
    return false;
  }

  /// On a square page the placer's box says the same as the smallest one, and is known.
  [[nodiscard]] Vec2 least_box(std::size_t island) const {
    if (grid_.aspect == 1) return placer_.box(island).size;
    return smallest_box(charts::points_of(outlines_[island])).size;
  }

  [[nodiscard]] std::int64_t work(double a_share) const {
    return static_cast<std::int64_t>(shares_ * a_share);
  }

  PackResult on_several() {
    std::vector<Arrangement> starts = usual_arrangements(placer_);
    const std::size_t n = placer_.size();
    double side = grid_.columns(fine_cells(n));
    double scale = usual_scale(placer_, grid_, page_.packing.max_pages, side);
    if (n > kSearched) starts.resize(1);
    for (const Level& level : kLevels) {
      if (n > kSearched) break;
      const int cells = grid_.columns(cells_for(n, level.per_island, level.cells));
      const double loose = scale / side * cells;
      const CellPacking found = on_grid(starts, cells, loose, work(level.work));
      starts = {found.arrangement};
      scale = loose;
      side = found.side;
    }
    const int fine = fine_side();
    return to_result(on_grid_exactly(starts, fine, fine * scale / side / kSpareSide));
  }

  /// Searches at this scale, with the padding of pages of `side` cells.
  CellPacking on_grid(const std::vector<Arrangement>& starts, int side, double cells_per_unit,
                      std::int64_t work) {
    placer_.set_scale(cells_per_unit, grid_.padding(side));
    Budget budget{work, stop_};
    return smallest_pages(placer_, starts, {page_.packing.max_pages, grid_.ratio()}, budget);
  }

  /// The same with exact padding: if the pages come out larger than `side`, the islands shrink and
  /// the search is repeated.
  CellPacking on_grid_exactly(const std::vector<Arrangement>& starts, int side,
                              double cells_per_unit) {
    for (;;) {
      CellPacking found = on_grid(starts, side, cells_per_unit, work(kFineWork));
      if (found.side <= side) return found;
      cells_per_unit *= double(side) / found.side / kSpareSide;
    }
  }

  PackResult to_result(const CellPacking& found) {
    return {placements_of(found, placer_, grid_), static_cast<Index>(found.pages), padding_, {}};
  }

  std::span<const charts::Outline> outlines_;
  BottomLeftPlacer placer_;
  double shares_;
  PageOptions page_;
  double padding_;
  PageGrid grid_;
  Executor& executor_;
  std::stop_token stop_;
};

std::vector<UvMap> points_of(std::span<const charts::Outline> islands) {
  std::vector<UvMap> points;
  points.reserve(islands.size());
  for (const charts::Outline& island : islands) points.push_back(charts::points_of(island));
  return points;
}

bool has_extent(std::span<const UvMap> points) {
  return std::any_of(points.begin(), points.end(),
                     [](const UvMap& own) { return smallest_box(own).size.prod() > 0; });
}

PackResult pack_apart(std::span<const charts::Outline> islands, const PageOptions& page,
                      Executor& executor) {
  if (page.packing.texels_per_unit)
    return Packer(islands, page, executor).at_density(*page.packing.texels_per_unit);
  const std::vector<UvMap> points = points_of(islands);
  const bool is_free = page.packing.rotation == Rotation::any;
  PackResult rows{is_free ? pack_in_rows(points, page) : pack_outlines_in_rows(islands, page),
                  1,
                  kept_padding(page, islands.size()),
                  {}};
  const bool are_too_many = islands.size() > kMostApart && page.packing.max_pages == 1;
  if (islands.size() < 2 || are_too_many || !has_extent(points)) return rows;
  PackResult tight = Packer(islands, page, executor).largest();
  return tight.placements.front().scale > rows.placements.front().scale ? tight : rows;
}

}  // namespace

double rough_fill(std::span<const charts::Outline> islands, const RoughRules& rules,
                  const std::stop_token& stop) {
  if (islands.empty() || !has_extent(points_of(islands))) return 1;
  double area = 0;
  for (const charts::Outline& island : islands) area += charts::area_of(island);
  SerialExecutor serial;
  JobExecutor executor(serial, stop);
  return Packer(islands, {.padding = 0}, executor).rough_fill(area, rules);
}

PackResult pack(std::span<const charts::Outline> islands, const PageOptions& page,
                Executor& executor) {
  if (islands.empty()) return {};
  const auto apart = [&](std::span<const charts::Outline> each) {
    return pack_apart(each, page, executor);
  };
  return page.packing.stack_identical
             ? pack_stacked(islands, page.packing.rotation, apart, executor.stop())
             : apart(islands);
}

}  // namespace unwrapd::pack
