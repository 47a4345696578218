// Bottom-left placement on a grid whose cells locked islands have taken (ADR 0074). A locked island
// lies anywhere between cells: its outline gets the corner of its lowest cell as one more point, so
// that its mask begins there.
//
// A page that was packed tightly has a packing that this placement does not find again: then more
// and more of the islands stay where they are, the largest first, as long as they keep the padding
// there.
#include "core/pack/pack_around.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/mesh/cross.hpp"
#include "core/pack/anneal_packing.hpp"
#include "core/pack/box.hpp"
#include "core/pack/page_grid.hpp"
#include "core/pack/page_layout.hpp"

namespace unwrapd::pack {
namespace {

constexpr double kRoundingOfUvs = 1e-6;  // by which an island may cross the border of its page
constexpr double kWordsAround = 4e6;     // words for each island, up to kMostIslands of them
constexpr double kMostIslands = 12;
constexpr std::size_t kAllOrders = std::numeric_limits<std::size_t>::max();

[[noreturn]] void refuse_locked() {
  throw Error(ErrorCode::does_not_fit,
              "The other islands do not fit beside the locked ones; lock them, too, so that they "
              "stay, unlock some, raise max_pages, or lower padding.",
              "/locked_islands");
}

[[noreturn]] void refuse_large(std::size_t number) {
  throw Error(ErrorCode::does_not_fit,
              "One of the islands that are not locked (the " + std::to_string(number + 1) +
                  "th) is larger than a page; islands beside locked ones keep their sizes: make it "
                  "smaller, or lock none.",
              "/locked_islands");
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
    const Vec2 low = (charts::bounds_of(outline).first - origin) / cell_;
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
  const Vec2 size = smallest_box(charts::points_of(outline)).size;
  return size.minCoeff() > std::min(1.0, aspect) || size.maxCoeff() > std::hypot(1.0, aspect);
}

int turns_around(std::size_t islands) { return islands <= 100 ? 16 : 4; }

double distance_to_side(const Vec2& p, const std::array<Vec2, 2>& side) {
  const Vec2 way = side[1] - side[0], off = p - side[0];
  const double square = way.squaredNorm();
  const double share = square > 0 ? std::clamp(off.dot(way) / square, 0.0, 1.0) : 0;
  return (off - share * way).norm();
}

bool do_cross(const std::array<Vec2, 2>& s, const std::array<Vec2, 2>& t) {
  const auto turn = [](const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); };
  return turn(s[0], s[1], t[0]) * turn(s[0], s[1], t[1]) < 0 &&
         turn(t[0], t[1], s[0]) * turn(t[0], t[1], s[1]) < 0;
}

/// By its winding number, counted at the ray to the right.
bool is_inside(const Vec2& p, const charts::Outline& outline) {
  int winding = 0;
  for (const auto& [a, b] : outline) {
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const double x = a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (x > p.x()) winding += b.y() > a.y() ? 1 : -1;
  }
  return winding != 0;
}

struct BoundedOutline {
  explicit BoundedOutline(const charts::Outline& outline) : sides(&outline) {
    std::tie(low, high) = charts::bounds_of(outline);
  }

  const charts::Outline* sides;
  Vec2 low, high;
};

/// Whether two islands overlap or come nearer to each other than so much.
bool is_nearer(const BoundedOutline& own, const BoundedOutline& there, double distance) {
  const Vec2 reach = Vec2::Constant(distance);
  const Vec2 least = there.low - reach, most = there.high + reach;
  if ((own.high.array() < least.array()).any() || (own.low.array() > most.array()).any())
    return false;
  const charts::Outline &one = *own.sides, &other = *there.sides;
  if (is_inside(one.front()[0], other) || is_inside(other.front()[0], one)) return true;
  for (const auto& side : one) {
    const Vec2 a = side[0].cwiseMin(side[1]), b = side[0].cwiseMax(side[1]);
    if ((b.array() < least.array()).any() || (a.array() > most.array()).any()) continue;
    for (const auto& across : other)
      if (do_cross(side, across) || distance_to_side(side[0], across) < distance ||
          distance_to_side(across[0], side) < distance)
        return true;
  }
  return false;
}

bool keeps_border(const BoundedOutline& own, const PageOptions& page, double padding) {
  const int number = page_holding(*own.sides, page.aspect(), page.packing.max_pages);
  return number >= 0 && own.low.x() >= number + padding && own.high.x() <= number + 1 - padding &&
         own.low.y() >= padding && own.high.y() <= page.aspect() - padding;
}

}  // namespace

int page_holding(const charts::Outline& island, double aspect, int pages) {
  const auto [low, high] = charts::bounds_of(island);
  const double page = std::floor((low.x() + high.x()) / 2);
  const bool is_within = page >= 0 && page < pages && low.x() >= page - kRoundingOfUvs &&
                         high.x() <= page + 1 + kRoundingOfUvs && low.y() >= -kRoundingOfUvs &&
                         high.y() <= aspect + kRoundingOfUvs;
  return is_within ? static_cast<int>(page) : -1;
}

std::optional<PackResult> try_pack_around(std::span<const charts::Outline> islands,
                                          std::span<const charts::Outline> locked,
                                          const PageOptions& page, std::size_t most_orders,
                                          Executor& executor) {
  PackResult result{.placements = {}, .pages = 1, .padding = double(page.padding)};
  std::vector<int> pages;
  for (const charts::Outline& own : locked) {
    pages.push_back(page_holding(own, page.aspect(), page.packing.max_pages));
    result.pages = std::max(result.pages, static_cast<Index>(pages.back() + 1));
  }
  if (islands.empty()) return result;
  const PageGrid grid{static_cast<double>(page.padding) / page.resolution, page.aspect()};
  const int side = grid.tight_side(grid.columns(fine_cells(islands.size() + locked.size())));
  BottomLeftPlacer placer(islands, turns_around(islands.size()), page.packing.rotation);
  placer.set_scale(1 / grid.cell(side), grid.padding(side));
  const LockedCells cells(grid, side, grid.padding(side));
  std::vector<TakenCells> taken;
  for (std::size_t k = 0; k < locked.size(); ++k) taken.push_back(cells.of(locked[k], pages[k]));
  const double shares = std::min(static_cast<double>(islands.size()), kMostIslands);
  Budget budget{static_cast<std::int64_t>(kWordsAround * shares), executor.stop()};
  std::vector<Arrangement> orders = usual_arrangements(placer);
  orders.resize(std::min(orders.size(), most_orders));
  const CellPacking found =
      fewest_pages(placer, orders, cells.pages(page.packing.max_pages, taken), budget);
  if (found.side == 0) return std::nullopt;
  result.pages = std::max(result.pages, static_cast<Index>(found.pages));
  result.placements = placements_of(found, placer, grid);
  return result;
}

namespace {

/// The islands, the largest first, whose present places are as good as any: with the padding from
/// the border, from what is locked and from each other.
std::vector<std::size_t> well_placed(std::span<const charts::Outline> islands,
                                     std::span<const charts::Outline> locked,
                                     const PageOptions& page, const std::stop_token& stop) {
  std::vector<std::size_t> order(islands.size()), well;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t k) {
    return size_rank(std::abs(charts::area_of(islands[k])));
  });
  const double padding = static_cast<double>(page.padding) / page.resolution - kRoundingOfUvs;
  std::vector<BoundedOutline> there;
  for (const charts::Outline& own : locked) there.emplace_back(own);
  for (const std::size_t k : order) {
    const BoundedOutline own(islands[k]);
    if (!keeps_border(own, page, padding)) continue;
    if (std::ranges::any_of(there, [&](const BoundedOutline& other) {
          throw_if_cancelled(stop);
          return is_nearer(own, other, padding);
        }))
      continue;
    well.push_back(k);
    there.push_back(own);
  }
  return well;
}

}  // namespace

PackResult pack_around(std::span<const charts::Outline> islands,
                       std::span<const charts::Outline> locked, const PageOptions& page,
                       Executor& executor) {
  for (std::size_t k = 0; k < islands.size(); ++k)
    if (is_beyond_page(islands[k], page.aspect())) refuse_large(k);
  if (auto all = try_pack_around(islands, locked, page, kAllOrders, executor))
    return std::move(*all);
  const std::vector<std::size_t> well = well_placed(islands, locked, page, executor.stop());
  for (const double share : {0.5, 0.75, 1.0}) {
    const auto count = static_cast<std::size_t>(share * static_cast<double>(well.size()));
    std::vector<char> stays(islands.size(), 0);
    std::vector<charts::Outline> there(locked.begin(), locked.end()), rest;
    for (std::size_t k = 0; k < count; ++k) {
      stays[well[k]] = 1;
      there.push_back(islands[well[k]]);
    }
    for (std::size_t k = 0; k < islands.size(); ++k)
      if (stays[k] == 0) rest.push_back(islands[k]);
    const auto some = try_pack_around(rest, there, page, kAllOrders, executor);
    if (!some) continue;
    PackResult result{.placements = {}, .pages = some->pages, .padding = some->padding};
    std::size_t next = 0;
    for (const char own : stays)
      result.placements.push_back(own != 0 ? Placement{} : some->placements[next++]);
    return result;
  }
  refuse_locked();
}

}  // namespace unwrapd::pack
