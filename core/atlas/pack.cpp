// Islands are packed on the cells of coarse grids first, where a search among orders and turns is
// cheap, then with what was found on a fine one. In both they keep their scale and the page
// shrinks; the cells' size in texels, and with it the padding in cells, follows from its side.
#include "core/atlas/pack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/atlas/pack_search.hpp"
#include "core/atlas/pack_stacked.hpp"
#include "core/atlas/page_grid.hpp"
#include "core/atlas/squeeze.hpp"
#include "core/error.hpp"

namespace unwrapd {
namespace {

/// A grid that is searched.
struct Level {
  int cells = 0;          ///< a side, at least
  double per_island = 0;  ///< cells along a side, for each of as many islands
  double heat = 0;        ///< see StripRules
  std::int64_t work = 0;  ///< words an island
};
constexpr std::array kLevels = {Level{96, 12, 0.1, 18'000'000}, Level{160, 20, 0.01, 6'000'000}};
/// A grid on which few islands are squeezed together after a short search.
struct Squeeze {
  SqueezeRules rules;     ///< for 1024 cells a side; the first grid's side as it is
  std::int64_t work = 0;  ///< words an island
};
constexpr Level kStart = {96, 12, 0.1, 4'000'000};
constexpr std::array kSqueezes = {Squeeze{{128, 0, 1, 20}, 20'000'000},
                                  Squeeze{{512, 8, 2, 3}, 8'000'000},
                                  Squeeze{{1024, 8, 1, 3}, 8'000'000}};
constexpr std::size_t kSqueezed = 40;                // islands at most
constexpr int kFineCells = 1024, kMostCells = 4096;  // a side of the grid that decides
constexpr double kFinePerIsland = 30, kFineHeat = 0.002;
constexpr std::size_t kSearched = 400;  // islands at most that are searched on a coarse grid
constexpr double kUsualFill = 0.7, kFullBoxes = 0.9;  // a page: boxes, without and with padding
constexpr double kSpareSide = 1.005;  // by which islands are made smaller than they seem to fit
constexpr std::int64_t kFineWork = 1'000'000;  // words a share
constexpr std::int64_t kRoughWork = 500'000, kRoughSqueezeWork = 1'000'000;
constexpr double kMostShares = 12;   // of that work
constexpr double kSidesAShare = 30;  // of outlines: small shapes need no long search

int turns_for(std::size_t islands) {
  if (islands <= kSqueezed) return 48;
  return islands <= 100 ? 8 : 4;
}

/// Few islands have few orders and turns to try, and a handful of triangles is packed at once.
double shares_of(std::span<const Outline> outlines) {
  double sides = 0;
  for (const Outline& outline : outlines) sides += static_cast<double>(outline.size());
  return std::min({static_cast<double>(outlines.size()), sides / kSidesAShare, kMostShares});
}

int cells_for(std::size_t islands, double per_island, int least) {
  const double wanted = per_island * std::sqrt(static_cast<double>(islands));
  return static_cast<int>(std::clamp<double>(wanted, least, kMostCells));
}

int fine_cells(std::size_t islands) { return cells_for(islands, kFinePerIsland, kFineCells); }

double box_area(const Arranger& arranger) {
  double area = 0;
  for (std::size_t k = 0; k < arranger.size(); ++k) area += arranger.box(k).size.prod();
  return area;
}

class Packer {
 public:
  Packer(std::span<const Outline> outlines, const PageOptions& page, const std::stop_token& stop)
      : arranger_(outlines, turns_for(outlines.size())),
        shares_(shares_of(outlines)),
        page_(page),
        padding_(kept_padding(page, outlines.size())),
        grid_{padding_ / page.resolution},
        stop_(stop) {}

  /// As large as fits on the pages that are allowed.
  Packed largest() {
    if (arranger_.size() <= kSqueezed && page_.packing.max_pages == 1) {
      const std::optional<Found> few = few_on_a_page();
      if (few) return placed(*few);
    }
    std::vector<Arrangement> starts = usual_arrangements(arranger_);
    const std::size_t n = arranger_.size();
    double side = fine_cells(n);
    double scale = usual_scale(side);
    if (n > kSearched) starts.resize(1);
    for (const Level& level : kLevels) {
      if (n > kSearched) break;
      const int cells = cells_for(n, level.per_island, level.cells);
      const double loose = scale / side * cells;
      const std::vector<Found> found =
          on_grid(starts, {cells, level.heat}, loose, work(level.work));
      starts.clear();
      for (const Found& own : found) starts.push_back(own.arrangement);
      scale = loose;
      side = found.front().side;
    }
    const int fine = grid_.tight_side(fine_cells(n));
    starts.resize(1);
    return placed(on_grid_exactly(starts, fine, fine * scale / side / kSpareSide));
  }

  /// The share of the page that is filled after a short search on coarse grids, which ends where it
  /// is `enough`. area: of all islands.
  double rough_fill(double area, double enough) {
    const std::size_t n = arranger_.size();
    const int side = cells_for(n, kStart.per_island, kStart.cells);
    double scale = side * std::sqrt(kUsualFill / box_area(arranger_));
    std::vector<Arrangement> starts = usual_arrangements(arranger_);
    if (n > kSearched) starts.resize(1);
    const double tightest = std::sqrt(area / enough);  // page, in the islands' units
    const StripRules strip{side, kStart.heat, static_cast<int>(scale * tightest)};
    Found found = on_grid(starts, strip, scale, work(kRoughWork)).front();
    if (n <= kSqueezed && found.side > strip.enough) {
      SqueezeRules rules = kSqueezes.front().rules;
      const double ratio = double(rules.side) / found.side;
      rules.enough = static_cast<int>(scale * ratio * tightest);
      const Found tight = squeezed_on(rules, work(kRoughSqueezeWork), found, scale * ratio);
      if (tight.side > 0) scale *= ratio, found = tight;
    }
    return area * scale * scale / (double(found.side) * found.side);
  }

  /// At the density that is asked for, on as few pages as can be had.
  Packed at_density(double texels_per_unit) {
    const int side = grid_.tight_side(fine_cells(arranger_.size()));
    const double page_per_unit = texels_per_unit / page_.resolution;
    if (is_too_large(page_per_unit))
      refuse(
          "An island at this density is larger than a page; lower texels_per_unit, or raise "
          "resolution.");
    arranger_.set_scale(page_per_unit / grid_.cell(side), grid_.padding(side));
    Budget budget{work(kFineWork), stop_};
    const Found found = fewest_pages(arranger_, usual_arrangements(arranger_),
                                     {side, side, page_.packing.max_pages}, budget);
    if (found.side == 0)
      refuse(
          "The islands at this density do not fit on the pages; raise max_pages or resolution, or "
          "lower texels_per_unit.");
    return placed(found);
  }

 private:
  [[noreturn]] static void refuse(const std::string& message) {
    throw Error(ErrorCode::does_not_fit, message, "/texels_per_unit");
  }

  /// Looked at before any island is turned into cells, which would be too many. A square of the
  /// smallest box's shorter side lies in it; an island never fits where not even that does.
  [[nodiscard]] bool is_too_large(double page_per_unit) const {
    for (std::size_t k = 0; k < arranger_.size(); ++k) {
      const Vec2 size = page_per_unit * arranger_.box(k).size;
      if (size.minCoeff() > 1 || size.maxCoeff() > std::sqrt(2.0)) return true;
    }
    return false;
  }

  /// At which boxes with their padding fill a usual share of the pages of `side` cells.
  [[nodiscard]] double usual_scale(double side) const {
    const double margin = grid_.padding(side), all = static_cast<double>(arranger_.size());
    double area = 0, half = 0;  // of the equation area s^2 + 2 half s + all margin^2 = room
    for (std::size_t k = 0; k < arranger_.size(); ++k) {
      area += arranger_.box(k).size.prod();
      half += arranger_.box(k).size.sum() * margin / 2;
    }
    const double room = kFullBoxes * page_.packing.max_pages * side * side - all * margin * margin;
    return (std::sqrt(half * half + area * std::max(room, 0.2 * side * side)) - half) / area;
  }

  [[nodiscard]] std::int64_t work(std::int64_t a_share) const {
    return static_cast<std::int64_t>(shares_ * static_cast<double>(a_share));
  }

  /// Each grid begins with what was found on the one before; gaps come with the second.
  std::optional<Found> few_on_a_page() {
    const int cells = kStart.cells;
    double scale = cells * std::sqrt(kUsualFill / box_area(arranger_));
    Found found =
        on_grid(usual_arrangements(arranger_), {cells, kStart.heat}, scale, work(kStart.work))
            .front();
    for (const Squeeze& grid : kSqueezes) {
      SqueezeRules rules = grid.rules;
      if (rules.reach > 0) rules.side = grid_.tight_side(rules.side);
      scale *= double(rules.side) / found.side;
      found = squeezed_on(rules, work(grid.work), found, scale);
      if (found.side == 0) return std::nullopt;
      scale = arranger_.scale();
    }
    return found;
  }

  /// Pages must be no larger than those for which the padding was made: the islands shrink until
  /// they are.
  Found squeezed_on(const SqueezeRules& rules, std::int64_t work, const Found& from,
                    double cells_per_unit) {
    const bool has_gaps = rules.reach > 0;
    for (;;) {
      arranger_.set_scale(cells_per_unit, has_gaps ? grid_.padding(rules.side) : 0);
      Budget budget{work, stop_};
      Found found = squeezed(arranger_, from, rules, budget);
      if (!has_gaps || found.side <= rules.side) return found;
      cells_per_unit *= double(rules.side) / found.side / kSpareSide;
    }
  }

  /// A search at this scale, with the padding of pages of `expected` cells.
  std::vector<Found> on_grid(const std::vector<Arrangement>& starts, const StripRules& rules,
                             double cells_per_unit, std::int64_t work) {
    arranger_.set_scale(cells_per_unit, grid_.padding(rules.width));
    Budget budget{work, stop_};
    return page_.packing.max_pages == 1
               ? smallest_page(arranger_, starts, rules, budget)
               : std::vector{smallest_pages(arranger_, starts, page_.packing.max_pages, budget)};
  }

  /// The same where the padding must be kept: should pages come out larger than `side`, the islands
  /// shrink and all is done again.
  Found on_grid_exactly(const std::vector<Arrangement>& starts, int side, double cells_per_unit) {
    for (;;) {
      Found found = on_grid(starts, {side, kFineHeat}, cells_per_unit, work(kFineWork)).front();
      if (found.side <= side) return found;
      cells_per_unit *= double(side) / found.side / kSpareSide;
    }
  }

  Packed placed(const Found& found) {
    const double cell = grid_.cell(found.side);
    Packed packed{{}, static_cast<Index>(found.pages), padding_, {}};
    for (std::size_t k = 0; k < found.spots.size(); ++k) {
      const Spot& spot = found.spots[k];
      const Turn turn = arranger_.turn_of(k, spot.turn);
      const Vec2 moved = Vec2(spot.x, spot.y) - arranger_.mask_of(k, spot.turn).low;
      packed.placements.push_back(
          {turn.cosine, turn.sine, cell * turn.scale,
           Vec2(Vec2::Constant(grid_.border) + cell * moved + Vec2(spot.page, 0))});
    }
    return packed;
  }

  Arranger arranger_;
  double shares_;
  PageOptions page_;
  double padding_;
  PageGrid grid_;
  std::stop_token stop_;
};

std::vector<UvMap> points_of(std::span<const Outline> islands) {
  std::vector<UvMap> points(islands.size());
  for (std::size_t k = 0; k < islands.size(); ++k)
    for (const auto& [a, b] : islands[k]) points[k].push_back(a);
  return points;
}

bool has_extent(std::span<const UvMap> points) {
  return std::any_of(points.begin(), points.end(),
                     [](const UvMap& own) { return smallest_box(own).size.prod() > 0; });
}

Packed pack_apart(std::span<const Outline> islands, const PageOptions& page,
                  const std::stop_token& stop) {
  if (page.packing.texels_per_unit)
    return Packer(islands, page, stop).at_density(*page.packing.texels_per_unit);
  const std::vector<UvMap> points = points_of(islands);
  Packed rows{pack_in_rows(points, page), 1, kept_padding(page, islands.size()), {}};
  if (islands.size() < 2 || !has_extent(points)) return rows;
  Packed tight = Packer(islands, page, stop).largest();
  return tight.placements.front().scale > rows.placements.front().scale ? tight : rows;
}

double area_of(const Outline& outline) {
  double area = 0;
  for (const auto& [a, b] : outline) area += (a.x() * b.y() - a.y() * b.x()) / 2;
  return area;
}

}  // namespace

double rough_fill(std::span<const Outline> islands, double enough, const std::stop_token& stop) {
  if (islands.empty() || !has_extent(points_of(islands))) return 1;
  double area = 0;
  for (const Outline& island : islands) area += area_of(island);
  return Packer(islands, {.padding = 0}, stop).rough_fill(area, enough);
}

Packed pack(std::span<const Outline> islands, const PageOptions& page,
            const std::stop_token& stop) {
  if (islands.empty()) return {};
  const auto apart = [&](std::span<const Outline> each) { return pack_apart(each, page, stop); };
  return page.packing.stack_identical ? pack_stacked(islands, apart, stop) : apart(islands);
}

}  // namespace unwrapd
