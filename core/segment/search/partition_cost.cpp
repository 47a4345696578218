// Packing takes as long as merging, so it is left out where it can change nothing: where seams and
// charts alone cost too much, and where the surface has but a part of a page, for then other charts
// fill the gaps. It ends where the page is as full as it need be.
#include "core/segment/search/partition_cost.hpp"

#include <algorithm>

#include "core/pack/pack.hpp"
#include "core/segment/base/labels.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr double kMostPage = 1.5;  // of the surface
constexpr double kGrid = 0x1p22;   // steps on the side of the surface's area

/// Without the last digits: what differs by rounding alone is packed in the same way.
Vec2 on_grid(const Vec2& uv) { return (kGrid * uv).array().round() / kGrid; }

std::vector<charts::Outline> outlines(const SegmentationMesh& surface, const Partition& partition,
                                      const std::vector<Index>& owner) {
  std::vector<charts::Outline> all(partition.regions.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Region& region = partition.regions[k];
    for (std::size_t f = 0; f < region.faces.size(); ++f)
      for (Index i = 0; i < 3; ++i) {
        const Index h = 3 * region.faces[f] + i, twin = surface.halfedges.twin[h];
        const CornerUv& uv = region.uv[f];
        if (twin == kNoTwin || partition.open[h] != 0 ||
            owner[face_of(twin)] != static_cast<Index>(k))
          all[k].push_back({on_grid(uv[i]), on_grid(uv[(i + 1) % 3])});
      }
  }
  return all;
}

/// weight: one a half-edge.
double seam_of(const SegmentationMesh& surface, const Partition& partition,
               const std::vector<Index>& owner, const std::vector<double>& weight) {
  double seam = 0;
  for (std::size_t h = 0; h < partition.open.size(); ++h) {
    const Index twin = surface.halfedges.twin[h];
    if (twin == kNoTwin) continue;
    if (partition.open[h] != 0 || owner[face_of(twin)] != owner[h / 3]) seam += weight[h] / 2;
  }
  return seam;
}

}  // namespace

double seam_length(const SegmentationMesh& surface, const Partition& partition) {
  return seam_of(surface, partition, owners(surface, partition), surface.length);
}

PartitionCost partition_cost(const SegmentationMesh& surface, const Partition& partition,
                             const CostRules& rules) {
  const std::vector<Index> owner = owners(surface, partition);
  const double length = seam_of(surface, partition, owner, surface.length);
  if (length <= 0) return {0, 0, 0};
  const double seam = seam_of(surface, partition, owner, surface.seam_cost);
  double charts = 0;
  for (const MappedRegion& region : partition.regions)
    charts += region.area < kSmallRegion ? rules.small_chart : rules.chart;
  PartitionCost cost{.seams = rounded(seam + charts), .length = rounded(length)};
  if (cost.length >= rules.longest || cost.seams >= rules.limit) return cost;
  cost.all = cost.seams;
  if (rules.page_area > kMostPage) return cost;
  const double fill = pack::rough_fill(outlines(surface, partition, owner),
                                       {rules.wanted_fill, rules.packing}, rules.stop);
  const double emptiness = std::max(0.0, rules.wanted_fill - fill);
  cost.all = rounded(seam + charts + kCostOfEmptiness * emptiness);
  return cost;
}

}  // namespace unwrapd::segment::search
