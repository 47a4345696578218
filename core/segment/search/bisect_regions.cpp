// The part of merge_search.hpp that takes large regions apart where the page stays empty.
//
// One cut at a time leads nowhere where several long regions each need the whole width of the
// page: it is no smaller before all of them are cut. So a page that is far from full is worth a few
// cuts in vain, the cheapest each.
#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/segment/base/labels.hpp"
#include "core/segment/search/bisect.hpp"
#include "core/segment/search/close_slits.hpp"
#include "core/segment/search/merge_search.hpp"
#include "core/solve/base/parallel_map.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr int kCutsInVain = 4;  // that are tried where a page is far from full
constexpr double kMuchEmptiness = 0.2;
constexpr double kNearlyAsLong = 0.7;  // of the longest region
constexpr double kAny = std::numeric_limits<double>::infinity();

/// Of the box of a region's map.
double longer_side(const Region& region) {
  Vec2 low = region.uv.front()[0], high = low;
  for (const CornerUv& corners : region.uv)
    for (const Vec2& uv : corners) {
      low = low.cwiseMin(uv);
      high = high.cwiseMax(uv);
    }
  return (high - low).maxCoeff();
}

/// The longest region and those nearly as long, the longest first. Halving a shorter one cannot
/// shrink the page: the longest still has to fit.
std::vector<std::size_t> long_regions(const std::vector<MappedRegion>& regions) {
  std::vector<double> side;
  for (const MappedRegion& region : regions) side.push_back(rounded(longer_side(region)));
  const double least = kNearlyAsLong * std::ranges::max(side);
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < regions.size(); ++k)
    if (side[k] >= least) found.push_back(k);
  std::ranges::stable_sort(found, std::greater(), [&](std::size_t k) { return side[k]; });
  return found;
}

}  // namespace

bool MergeSearch::is_far_from_full(const PartitionCost& cost) {
  return cost.all - cost.seams > kMuchEmptiness * kCostOfEmptiness;
}

/// The ways to part one of the longest regions that have sound maps, with their costs. Of those
/// whose seams cost the same, one.
std::vector<Candidate> MergeSearch::all_parted(const Candidate& whole) {
  const std::vector<std::size_t> longest = long_regions(whole.partition.regions);
  std::vector<Candidate> all = solve::parallel_map<Candidate>(
      longest.size() * kWaysToBisect, executor_,
      [&](std::size_t k) { return parted(whole, longest[k / kWaysToBisect], k % kWaysToBisect); });
  learn(all);
  all = distinct(std::move(all));
  const double limit = is_far_from_full(whole.cost) ? kAny : whole.cost.all;
  return solve::parallel_map<Candidate>(
      all.size(), executor_, [&](std::size_t k) { return price_parted(std::move(all[k]), limit); });
}

Candidate MergeSearch::bisect_regions(Candidate whole, Index most) {
  Candidate best = price_parted(std::move(whole), kAny), now = best;
  const auto may_be_cut = [&] {
    return now.cost.all > now.cost.seams && std::cmp_less(now.partition.regions.size(), most);
  };
  for (int in_vain = 0; may_be_cut();) {
    std::vector<Candidate> all = all_parted(now);
    const auto next = std::ranges::min_element(all, std::less(),
                                               [](const Candidate& own) { return own.cost.all; });
    if (next == all.end() || next->cost.all == kAny) break;
    const bool is_better = next->cost.all < best.cost.all;
    if (!is_better && (in_vain == kCutsInVain || !is_far_from_full(now.cost))) break;
    in_vain = is_better ? 0 : in_vain + 1;
    now = std::move(*next);
    if (is_better) best = now;
  }
  close_slits(context_, settings_, best.partition);
  return best;
}

}  // namespace unwrapd::segment::search
