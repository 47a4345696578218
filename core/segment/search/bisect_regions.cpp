// The part of merge_search.hpp that takes large regions apart where the page stays empty.
//
// One half at a time leads nowhere where several long regions each need the whole width of the
// page: it is no smaller before all of them are in halves. So a page that is far from full is worth
// a few halves in vain, of the longest region each.
#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/segment/search/close_slits.hpp"
#include "core/segment/search/merge_search.hpp"
#include "core/solve/base/parallel_map.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr int kHalvesInVain = 4;  // that are tried where a page is far from full
constexpr double kMuchEmptiness = 0.2;

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

/// The longest of the regions that can be halved.
std::ptrdiff_t longest_of(const std::vector<MappedRegion>& regions,
                          const std::vector<Candidate>& halved) {
  std::ptrdiff_t longest = 0;
  double most = 0;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const double own = halved[k].partition.regions.empty() ? 0 : longer_side(regions[k]);
    if (own > most) most = own, longest = static_cast<std::ptrdiff_t>(k);
  }
  return longest;
}

}  // namespace

bool MergeSearch::is_far_from_full(const PartitionCost& cost) {
  return cost.all - cost.seams > kMuchEmptiness * kCostOfEmptiness;
}

Candidate MergeSearch::bisect_regions(Candidate whole) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  Candidate best = price_halves(std::move(whole), kAny), now = best;
  for (int in_vain = 0; now.cost.all > now.cost.seams;) {
    std::vector<Candidate> halved =
        solve::parallel_map<Candidate>(now.partition.regions.size(), executor_,
                                       [&](std::size_t k) { return with_halves(now, k); });
    learn(halved);
    auto next = std::ranges::min_element(halved, std::less(),
                                         [](const Candidate& own) { return own.cost.all; });
    const bool is_better = next->cost.all < best.cost.all;
    if (!is_better) {
      if (in_vain == kHalvesInVain || !is_far_from_full(now.cost)) break;
      next = halved.begin() + longest_of(now.partition.regions, halved);
      if (next->partition.regions.empty()) break;
    }
    in_vain = is_better ? 0 : in_vain + 1;
    now = std::move(*next);
    if (is_better) best = now;
  }
  close_slits(context_, settings_, best.partition);
  return best;
}

}  // namespace unwrapd::segment::search
