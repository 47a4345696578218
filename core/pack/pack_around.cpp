// Bottom-left placement on a grid whose cells locked islands have taken (ADR 0074). A locked island
// lies anywhere between cells: its outline gets the corner of its lowest cell as one more point, so
// that its mask begins there.
#include "core/pack/pack_around.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/pack/anneal_packing.hpp"
#include "core/pack/box.hpp"
#include "core/pack/page_grid.hpp"
#include "core/pack/page_layout.hpp"

namespace unwrapd::pack {
namespace {

constexpr double kRoundingOfUvs = 1e-6;  // by which an island may cross the border of its page
constexpr double kWordsAround = 4e6;     // words for each island, up to kMostIslands of them
constexpr double kMostIslands = 12;

[[noreturn]] void refuse_locked() {
  throw Error(ErrorCode::does_not_fit,
              "The other islands do not fit beside the locked ones; unlock some, raise max_pages, "
              "or lower padding.",
              "/locked_islands");
}

UvMap points_of_sides(const charts::Outline& outline) {
  UvMap points;
  for (const auto& [a, b] : outline) points.push_back(a);
  return points;
}

/// An outline's least and greatest coordinates.
std::pair<Vec2, Vec2> bounds_of_outline(const charts::Outline& outline) {
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (const auto& [a, b] : outline) {
    low = low.cwiseMin(a);
    high = high.cwiseMax(a);
  }
  return {low, high};
}

/// The runs of a row within [begin, end).
void append_clipped(std::span<const Run> runs, int begin, int end, Rows& rows) {
  for (const Run& run : runs)
    if (run.end > begin && run.begin < end)
      rows.runs.push_back({std::max(run.begin, begin), std::min(run.end, end)});
  rows.first.push_back(static_cast<int>(rows.runs.size()));
}

class LockedCells {
 public:
  LockedCells(const PageGrid& grid, int side, double padding)
      : grid_(grid),
        cell_(grid.cell(side)),
        width_(side),
        height_(rows_of(side, grid.ratio())),
        margin_(margin_of(padding)) {}

  /// Cells beyond the margin are nobody's.
  [[nodiscard]] TakenCells of(charts::Outline outline, int page) const {
    const Vec2 origin(page + grid_.border, grid_.border);
    const Vec2 low = (bounds_of_outline(outline).first - origin) / cell_;
    TakenCells taken{{}, cell_below(low.x()), cell_below(low.y()), page};
    for (auto& side : outline)
      for (Vec2& end : side) end = (end - origin) / cell_ - Vec2(taken.x, taken.y);
    outline.push_back({Vec2::Zero(), Vec2::Zero()});
    Mask whole = make_mask(outline, {}, 0);
    taken.y = std::max(taken.y, -margin_);
    for (int y = 0; y < whole.touched.height(); ++y) {
      const int row = y + cell_below(low.y());
      if (row < -margin_ || row >= height_ + margin_) continue;
      append_clipped(whole.touched.row(y), -margin_ - taken.x, width_ + margin_ - taken.x,
                     taken.mask.touched);
    }
    return taken;
  }

  [[nodiscard]] PageCells pages(int count, std::span<const TakenCells> taken) const {
    return {width_, height_, count, taken};
  }

 private:
  static int cell_below(double x) { return static_cast<int>(std::floor(x)); }

  const PageGrid& grid_;
  double cell_;
  int width_, height_, margin_;
};

/// Tested before any island is rasterized: its smallest box contains a square of its shorter side.
bool is_beyond_page(const charts::Outline& outline, double aspect) {
  const Vec2 size = smallest_box(points_of_sides(outline)).size;
  return size.minCoeff() > std::min(1.0, aspect) || size.maxCoeff() > std::hypot(1.0, aspect);
}

int turns_around(std::size_t islands) { return islands <= 100 ? 16 : 4; }

}  // namespace

int page_holding(const charts::Outline& island, double aspect, int pages) {
  const auto [low, high] = bounds_of_outline(island);
  const double page = std::floor((low.x() + high.x()) / 2);
  const bool is_within = page >= 0 && page < pages && low.x() >= page - kRoundingOfUvs &&
                         high.x() <= page + 1 + kRoundingOfUvs && low.y() >= -kRoundingOfUvs &&
                         high.y() <= aspect + kRoundingOfUvs;
  return is_within ? static_cast<int>(page) : -1;
}

PackResult pack_around(std::span<const charts::Outline> islands,
                       std::span<const charts::Outline> locked, const PageOptions& page,
                       Executor& executor) {
  PackResult result{.placements = {}, .pages = 1, .padding = double(page.padding)};
  std::vector<int> pages;
  for (const charts::Outline& own : locked) {
    pages.push_back(page_holding(own, page.aspect(), page.packing.max_pages));
    result.pages = std::max(result.pages, static_cast<Index>(pages.back() + 1));
  }
  if (islands.empty()) return result;
  for (const charts::Outline& own : islands)
    if (is_beyond_page(own, page.aspect())) refuse_locked();
  const PageGrid grid{static_cast<double>(page.padding) / page.resolution, page.aspect()};
  const int side = grid.tight_side(grid.columns(fine_cells(islands.size() + locked.size())));
  BottomLeftPlacer placer(islands, turns_around(islands.size()), page.packing.rotation);
  placer.set_scale(1 / grid.cell(side), grid.padding(side));
  const LockedCells cells(grid, side, grid.padding(side));
  std::vector<TakenCells> taken;
  for (std::size_t k = 0; k < locked.size(); ++k) taken.push_back(cells.of(locked[k], pages[k]));
  const double shares = std::min(static_cast<double>(islands.size()), kMostIslands);
  Budget budget{static_cast<std::int64_t>(kWordsAround * shares), executor.stop()};
  const CellPacking found = fewest_pages(placer, usual_arrangements(placer),
                                         cells.pages(page.packing.max_pages, taken), budget);
  if (found.side == 0) refuse_locked();
  result.pages = std::max(result.pages, static_cast<Index>(found.pages));
  result.placements = placements_of(found, placer, grid);
  return result;
}

}  // namespace unwrapd::pack
