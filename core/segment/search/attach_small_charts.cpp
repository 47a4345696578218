// Merging glues two regions along their whole border, or along its longest stretch. The tips of
// fingers, ears and mouths fit their surroundings in neither way, because these are as wide as the
// tip, or curl. Attached by one edge, a tip needs only room beside it.
#include "core/segment/search/attach_small_charts.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "core/mesh/edges.hpp"
#include "core/segment/base/labels.hpp"
#include "core/segment/base/region_pair.hpp"
#include "core/segment/search/remap.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr std::size_t kNeighbours = 2;  // that are asked

/// Half-edges of the small region in a row, across which the other one lies.
using Stretch = std::vector<Index>;

class Attaching {
 public:
  Attaching(const MergeContext& context, const MergeSettings& settings, Partition& partition)
      : context_(context),
        surface_(context.surface),
        settings_(settings),
        partition_(partition),
        owner_(owners(surface_, partition)) {
    for (const MappedRegion& region : partition.regions) total_ += region.excess;
  }

  void run() {
    std::vector<std::size_t> order(partition_.regions.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::less(),
                             [&](std::size_t k) { return rounded(partition_.regions[k].area); });
    for (const std::size_t k : order)
      if (partition_.regions[k].area < kSmallRegion) attach(static_cast<Index>(k));
    std::erase_if(partition_.regions,
                  [](const MappedRegion& region) { return region.faces.empty(); });
  }

 private:
  [[nodiscard]] Index twin(Index h) const { return surface_.halfedges.twin[h]; }

  [[nodiscard]] bool is_seam(Index h) const {
    return twin(h) == kNoTwin || partition_.open[h] != 0 ||
           owner_[face_of(h)] != owner_[face_of(twin(h))];
  }

  /// The seam that goes on from h around its region.
  [[nodiscard]] Index next(Index h) const {
    Index g = next_halfedge(h);
    while (!is_seam(g)) g = next_halfedge(twin(g));
    return g;
  }

  [[nodiscard]] Index across(Index h) const {
    return twin(h) == kNoTwin || partition_.open[h] != 0 ? -1 : owner_[face_of(twin(h))];
  }

  /// Towards each neighbour, the longest of all first.
  [[nodiscard]] std::vector<Stretch> stretches(Index k) const {
    std::vector<Index> sides;
    std::map<Index, Index> before;
    for (const Index t : partition_.regions[k].faces)
      for (Index h = 3 * t; h < 3 * t + 3; ++h)
        if (is_seam(h)) sides.push_back(h), before[next(h)] = h;
    std::map<Index, char> taken;
    std::vector<Stretch> all;
    for (const Index side : sides) {
      const Index other = across(side);
      if (other < 0 || other == k || taken.contains(side)) continue;
      Index first = side;
      while (across(before.at(first)) == other && before.at(first) != side)
        first = before.at(first);
      Stretch stretch;
      for (Index h = first; across(h) == other && !taken.contains(h); h = next(h)) {
        taken[h] = 1;
        stretch.push_back(h);
      }
      all.push_back(std::move(stretch));
    }
    std::ranges::stable_sort(all, std::greater(), [&](const Stretch& own) { return length(own); });
    return all;
  }

  [[nodiscard]] double length(std::span<const Index> edges) const {
    double sum = 0;
    for (const Index h : edges) sum += surface_.length[h];
    return rounded(sum);
  }

  void attach(Index k) {
    const std::vector<Stretch> all = stretches(k);
    for (std::size_t s = 0; s < std::min(all.size(), kNeighbours); ++s) {
      const std::span<const Index> stretch = all[s];
      const std::size_t n = stretch.size(), half = n / 2;
      std::vector<std::span<const Index>> pieces{stretch};
      if (n > 2) pieces.insert(pieces.end(), {stretch.first(half), stretch.subspan(half)});
      for (const std::size_t at : {half, std::size_t{0}, n - 1, n / 4, n - 1 - n / 4})
        pieces.push_back(stretch.subspan(at, 1));
      for (const std::span<const Index> piece : pieces)
        if (glue(k, across(stretch.front()), piece)) return;
    }
  }

  /// Whether small region k and the other have a sound map glued there; then they are one.
  bool glue(Index k, Index into, std::span<const Index> edges) {
    MappedRegion &own = partition_.regions[k], &other = partition_.regions[into];
    if (!own.is_sound || !other.is_sound) return false;
    std::vector<char> open = partition_.open;
    for (const Index t : own.faces)
      for (Index h = 3 * t; h < 3 * t + 3; ++h)
        if (across(h) == into) open[h] = open[twin(h)] = 1;
    for (const Index h : edges) open[h] = open[twin(h)] = 0;
    MappedRegion both = unite(other, own, beside(surface_, other, own, edges));
    both.is_sound = true;
    if (!remap(context_, settings_, open, own.excess + other.excess, both, total_)) return false;
    for (const Index t : own.faces) owner_[t] = into;
    partition_.open = std::move(open);
    other = std::move(both);
    own = {};
    return true;
  }

  const MergeContext& context_;
  const SegmentationMesh& surface_;
  const MergeSettings& settings_;
  Partition& partition_;
  std::vector<Index> owner_;  ///< one a face
  ExcessDistortion total_;
};

}  // namespace

void attach_small_charts(const MergeContext& context, const MergeSettings& settings,
                         Partition& partition) {
  Attaching(context, settings, partition).run();
}

}  // namespace unwrapd::segment::search
