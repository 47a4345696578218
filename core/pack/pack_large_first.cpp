// Many islands are placed one after another, and none moves once it lies. That wastes what few
// large ones could fill by moving, so these are packed alone. All of them then shrink into a corner
// of the page, no further than needed for the others to find places beside them.
#include "core/pack/pack_large_first.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "core/pack/box.hpp"
#include "core/pack/pack_around.hpp"
#include "core/pack/pack_few.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {
namespace {

constexpr double kMostOfArea = 0.9;  // held by the large islands
constexpr double kNearlyAll = 0.98;  // held by those that are squeezed, or by as many as can be
constexpr double kSmallest = 0.86;   // scale factor of the large islands' arrangement
constexpr int kHalvings = 6;         // of the range of that factor
constexpr std::size_t kOrders = 1;   // in which the others are set down; more seldom fit better

struct BySize {
  std::vector<std::size_t> large, others;
};

/// large: the fewest that hold that share of the area, or `most` of them; two at least.
BySize by_size(std::span<const charts::Outline> islands, double share, std::size_t most) {
  std::vector<double> area;
  for (const charts::Outline& own : islands) area.push_back(std::abs(charts::area_of(own)));
  std::vector<std::size_t> order(islands.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t k) { return size_rank(area[k]); });
  double missing = share * std::accumulate(area.begin(), area.end(), 0.0);
  BySize sizes;
  for (const std::size_t k : order) {
    const std::size_t count = sizes.large.size();
    const bool is_large = count < 2 || (missing > 0 && count < most);
    (is_large ? sizes.large : sizes.others).push_back(k);
    missing -= area[k];
  }
  return sizes;
}

std::vector<charts::Outline> picked(std::span<const charts::Outline> islands,
                                    const std::vector<std::size_t>& numbers) {
  std::vector<charts::Outline> some;
  for (const std::size_t k : numbers) some.push_back(islands[k]);
  return some;
}

charts::Outline placed(charts::Outline outline, const Placement& placement) {
  for (auto& side : outline)
    for (Vec2& end : side) end = placement(end);
  return outline;
}

Placement towards_corner(Placement placement, double factor) {
  placement.scale *= factor;
  placement.offset *= factor;
  return placement;
}

class LargeFirst {
 public:
  LargeFirst(std::span<const charts::Outline> islands, BySize sizes, const PageOptions& page,
             Executor& executor)
      : sizes_(std::move(sizes)),
        large_(picked(islands, sizes_.large)),
        others_(picked(islands, sizes_.others)),
        page_(page),
        executor_(executor) {}

  std::optional<std::vector<Placement>> packed() const {
    const PageGrid roomy{page_.padding / kSmallest / page_.resolution, page_.aspect()};
    const auto full = pack_few(large_, roomy, page_.packing.rotation, page_.effort, executor_);
    if (!full) return std::nullopt;
    auto best = with_others(*full, kSmallest);
    double fits = kSmallest, fails = 1;
    for (int k = 0; best && k < kHalvings; ++k) {
      const double factor = (fits + fails) / 2;
      auto larger = with_others(*full, factor);
      (larger ? fits : fails) = factor;
      if (larger) best = std::move(larger);
    }
    return best;
  }

 private:
  /// full: the places of the large islands on a page of their own.
  [[nodiscard]] std::optional<std::vector<Placement>> with_others(
      const std::vector<Placement>& full, double factor) const {
    std::vector<Placement> placements(large_.size() + others_.size());
    std::vector<charts::Outline> taken, free;
    for (std::size_t k = 0; k < large_.size(); ++k) {
      Placement& own = placements[sizes_.large[k]] = towards_corner(full[k], factor);
      taken.push_back(placed(large_[k], own));
    }
    const Placement shrunk{.scale = full.front().scale * factor};
    for (const charts::Outline& own : others_) free.push_back(placed(own, shrunk));
    const auto around = try_pack_around(free, taken, page_, kOrders, executor_);
    if (!around) return std::nullopt;
    for (std::size_t k = 0; k < others_.size(); ++k) {
      Placement& own = placements[sizes_.others[k]] = around->placements[k];
      own.scale = shrunk.scale;
    }
    return placements;
  }

  BySize sizes_;
  std::vector<charts::Outline> large_, others_;
  const PageOptions& page_;
  Executor& executor_;
};

}  // namespace

std::size_t count_large(std::span<const charts::Outline> islands) {
  return by_size(islands, kMostOfArea, islands.size()).large.size();
}

std::optional<std::vector<Placement>> pack_large_first(std::span<const charts::Outline> islands,
                                                       const PageOptions& page,
                                                       Executor& executor) {
  BySize sizes = by_size(islands, kNearlyAll, kFewOnAPage);
  if (sizes.others.empty() || charts::area_of(islands[sizes.large.front()]) == 0)
    return std::nullopt;
  return LargeFirst(islands, std::move(sizes), page, executor).packed();
}

}  // namespace unwrapd::pack
