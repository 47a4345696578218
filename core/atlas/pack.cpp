// Bottom-left placement on a bitmap of the page, for ever larger scales: each island, the largest
// first, takes the lowest free place of several turns. An island that finds none goes to the front
// of the order, and the page is tried again: those that are hard to place settle first.
// Orders and turns are found on a coarse bitmap; a fine one then only has to find the scale.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/atlas/box.hpp"
#include "core/atlas/occupancy.hpp"
#include "core/atlas/pack.hpp"

namespace unwrapd {
namespace {

constexpr int kCoarseCells = 128, kFineCells = 512;  // a side of the bitmap
constexpr double kCellsPerIsland = 12;               // along a side of the coarse one, at least
constexpr double kPaddingsPerIsland = 64;            // squares of padding on the page, at least
constexpr std::size_t kMostIslands = 4'000;          // beyond: rows will do
constexpr std::size_t kFewIslands = 64;              // for which many turns are tried
constexpr int kManyTurns = 8, kFewTurns = 4;
constexpr int kRetries = 6;                              // with another order, at one scale
constexpr double kCoarseStep = 1.04, kFineStep = 1.015;  // between one scale and the next
constexpr double kCoarseSlack = 0.9;  // coarse cells waste some of what rows can do
constexpr int kRefinements = 3;       // bisections once a scale does not fit

struct Spot {
  int x = 0, y = 0;
  int turn = 0;
};

/// The page in cells.
struct Grid {
  int side = 0;
  int padding = 0;
  double cell = 0;    ///< page units
  double border = 0;  ///< of the first cell, page units
};

Grid grid_of(const PageOptions& page, int side) {
  const double texel = 1.0 / page.resolution, border = page.padding * texel;
  const double cell = (1 - 2 * border) / side;
  return {side, static_cast<int>(std::ceil(border / cell)), cell, border};
}

/// Size classes: islands of one class that came late find no lower place than the one before.
class Hints {
 public:
  int& of(const Mask& mask) {
    return lowest_[class_of(mask.width)][class_of(mask.touched.height())];
  }

 private:
  static std::size_t class_of(int cells) {
    return static_cast<std::size_t>(4 * std::log2(static_cast<double>(cells) + 1));
  }
  std::array<std::array<int, 48>, 48> lowest_{};
};

class Fitting {
 public:
  Fitting(std::span<const Outline> outlines, const Grid& grid)
      : outlines_(outlines),
        grid_(grid),
        turns_(outlines.size() <= kFewIslands ? kManyTurns : kFewTurns) {
    for (const Outline& outline : outlines) {
      UvMap points;
      for (const auto& [a, b] : outline) points.push_back(a);
      boxes_.push_back(smallest_box(points));
    }
    order_.resize(outlines.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](Index a, Index b) {
      return boxes_[static_cast<std::size_t>(a)].size.maxCoeff() >
             boxes_[static_cast<std::size_t>(b)].size.maxCoeff();
    });
  }

  /// On a finer grid, with the order found so far and the turns of the last scale that was kept.
  void refine(const Grid& grid) {
    grid_ = grid;
    turns_are_fixed_ = true;
  }

  /// Tries a scale (page units for one unit of the islands) with several orders; keeps it if it
  /// fits.
  bool try_scale(double scale) {
    masks_.assign(outlines_.size() * static_cast<std::size_t>(turns_), std::nullopt);
    scale_ = scale / grid_.cell;
    std::vector<Index> order = order_;
    for (int k = 0; k < kRetries; ++k) {
      const std::optional<Index> homeless = place_all(order);
      if (!homeless) return keep(std::move(order));
      const auto at = std::find(order.begin(), order.end(), *homeless);
      if (at == order.begin()) return false;
      std::rotate(order.begin(), at, at + 1);
    }
    return false;
  }

  /// Those of the last scale that was kept; empty when none was.
  [[nodiscard]] const std::vector<Placement>& placements() const { return placements_; }

 private:
  bool keep(std::vector<Index> order) {
    order_ = std::move(order);
    kept_ = spots_;
    placements_.clear();
    for (std::size_t k = 0; k < outlines_.size(); ++k) {
      const Turn turn = turn_of(static_cast<Index>(k), spots_[k].turn);
      const Mask& mask = mask_of(static_cast<Index>(k), spots_[k].turn);
      const Vec2 moved = Vec2(spots_[k].x, spots_[k].y) - mask.low;
      placements_.push_back({turn.cosine, turn.sine, grid_.cell * turn.scale,
                             Vec2(Vec2::Constant(grid_.border) + grid_.cell * moved)});
    }
    return true;
  }

  Turn turn_of(Index island, int turn) const {
    const Box& box = boxes_[static_cast<std::size_t>(island)];
    const double angle = 2 * std::numbers::pi * turn / turns_ + std::atan2(box.sine, box.cosine);
    return {std::cos(angle), std::sin(angle), scale_};
  }

  const Mask& mask_of(Index island, int turn) {
    auto& mask = masks_[static_cast<std::size_t>(island * turns_ + turn)];
    if (!mask)
      mask = make_mask(outlines_[static_cast<std::size_t>(island)], turn_of(island, turn),
                       grid_.padding);
    return *mask;
  }

  /// The first island that finds no place.
  std::optional<Index> place_all(const std::vector<Index>& order) {
    Occupancy page(grid_.side, grid_.padding);
    Hints hints;
    spots_.assign(outlines_.size(), {});
    for (Index island : order)
      if (!place(island, page, hints)) return island;
    return std::nullopt;
  }

  bool place(Index island, Occupancy& page, Hints& hints) {
    int lowest_top = page.side() + 1;
    Spot best;
    for (int turn = 0; turn < turns_; ++turn) {
      if (turns_are_fixed_ && turn != kept_[static_cast<std::size_t>(island)].turn) continue;
      const Mask& mask = mask_of(island, turn);
      int& hint = hints.of(mask);
      for (int y = hint; y + mask.touched.height() < lowest_top; ++y)
        if (const std::optional<int> x = page.first_free(mask, y)) {
          lowest_top = y + mask.touched.height();
          best = {*x, y, turn};
          if (outlines_.size() > kFewIslands) hint = y;
          break;
        }
    }
    if (lowest_top > page.side()) return false;
    spots_[static_cast<std::size_t>(island)] = best;
    page.stamp(mask_of(island, best.turn), best.x, best.y);
    return true;
  }

  std::span<const Outline> outlines_;
  Grid grid_;
  int turns_;
  double scale_ = 1;
  bool turns_are_fixed_ = false;
  std::vector<Box> boxes_;
  std::vector<Index> order_;
  std::vector<std::optional<Mask>> masks_;
  std::vector<Spot> spots_, kept_;
  std::vector<Placement> placements_;
};

/// Raises the scale in steps from one that may fit, then halves the last step. The largest that
/// fits, or `scale` where none does.
double largest_scale(Fitting& fitting, double scale, double step) {
  double too_large = scale * step;
  while (fitting.try_scale(too_large)) {
    scale = too_large;
    too_large *= step;
  }
  for (int k = 0; k < kRefinements; ++k) {
    const double middle = std::sqrt(scale * too_large);
    (fitting.try_scale(middle) ? scale : too_large) = middle;
  }
  return scale;
}

/// Placements of a scale larger than `least`; empty when none is found.
std::vector<Placement> fitted(std::span<const Outline> outlines, const PageOptions& page,
                              double least) {
  const auto coarse_side = std::clamp(
      static_cast<int>(kCellsPerIsland * std::sqrt(static_cast<double>(outlines.size()))),
      kCoarseCells, kFineCells);
  Fitting fitting(outlines, grid_of(page, coarse_side));
  const double coarse = largest_scale(fitting, kCoarseSlack * least, kCoarseStep);
  if (fitting.placements().empty()) return {};
  fitting.refine(grid_of(page, kFineCells));
  largest_scale(fitting, coarse, kFineStep);
  if (fitting.placements().front().scale <= least) return {};
  return fitting.placements();
}

}  // namespace

std::vector<Placement> pack(std::span<const Outline> islands, const PageOptions& page) {
  std::vector<UvMap> points;
  points.reserve(islands.size());
  for (const Outline& outline : islands) {
    points.emplace_back();
    for (const auto& [a, b] : outline) points.back().push_back(a);
  }
  std::vector<Placement> rows = pack_in_rows(points, page);
  const auto room = static_cast<double>(page.resolution) / std::max(page.padding, 1);
  const bool is_crowded = room * room < kPaddingsPerIsland * static_cast<double>(islands.size());
  if (islands.size() < 2 || islands.size() > kMostIslands || is_crowded) return rows;
  std::vector<Placement> tight = fitted(islands, page, rows.front().scale);
  return tight.empty() ? rows : tight;
}

}  // namespace unwrapd
