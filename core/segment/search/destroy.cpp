#include "core/segment/search/destroy.hpp"

#include <algorithm>

#include "core/base/splitmix64.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr double kMostLoose = 0.4;  // of the area, all of them together
constexpr std::uint64_t kSeedFactor = 1'000'003;

/// The regions that touch `centre`, ascending.
std::vector<Index> neighbours(const SegmentationMesh& surface, std::span<const Index> owner,
                              Index centre) {
  std::vector<Index> around;
  for (Index h = 0; h < static_cast<Index>(surface.halfedges.twin.size()); ++h) {
    const Index twin = surface.halfedges.twin[h];
    if (twin == kNoTwin || owner[face_of(h)] != centre || owner[face_of(twin)] == centre) continue;
    around.push_back(owner[face_of(twin)]);
  }
  std::ranges::sort(around);
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

/// A random region, drawn by area: small regions change little. seed: any number.
std::size_t drawn_by_area(std::span<const MappedRegion> regions, std::uint64_t seed) {
  double all = 0;
  for (const MappedRegion& region : regions) all += region.area;
  double left = all * static_cast<double>(seed >> 11) * 0x1p-53;
  std::size_t k = 0;
  for (; k + 1 < regions.size() && left >= regions[k].area; ++k) left -= regions[k].area;
  return k;
}

/// A random region, and neighbours in random order as long as there is room for them.
std::vector<char> drawn_regions(const SegmentationMesh& surface, const Partition& merged,
                                std::span<const Index> owner, std::uint64_t seed) {
  SplitMixSequence sequence(seed * kSeedFactor);
  std::vector<char> loose(merged.regions.size(), 0);
  const std::size_t centre = drawn_by_area(merged.regions, sequence.next());
  loose[centre] = 1;
  double area = merged.regions[centre].area;
  std::vector<Index> around = neighbours(surface, owner, static_cast<Index>(centre));
  while (!around.empty()) {
    const std::size_t k = sequence.below(around.size());
    const auto other = static_cast<std::size_t>(around[k]);
    around.erase(around.begin() + static_cast<std::ptrdiff_t>(k));
    if (area + merged.regions[other].area > kMostLoose) continue;
    loose[other] = 1;
    area += merged.regions[other].area;
  }
  return loose;
}

}  // namespace

Destroyed destroy(const SegmentationMesh& surface, const Partition& from, const Partition& merged,
                  std::uint64_t seed) {
  const std::vector<Index> owner = owners(surface, merged);
  const std::vector<char> loose = drawn_regions(surface, merged, owner, seed);
  Destroyed result{{{}, merged.open}, 0};
  for (std::size_t k = 0; k < loose.size(); ++k)
    if (loose[k] == 0) result.partition.regions.push_back(merged.regions[k]);
  result.whole = static_cast<Index>(result.partition.regions.size());
  for (const MappedRegion& region : from.regions) {
    if (loose[owner[region.faces.front()]] == 0) continue;
    result.partition.regions.push_back(region);
    for (const Index t : region.faces)
      for (Index h = 3 * t; h < 3 * t + 3; ++h) result.partition.open[h] = from.open[h];
  }
  return result;
}

}  // namespace unwrapd::segment::search
