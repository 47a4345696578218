#pragma once
// What a partition of a surface costs: what its user would see of it.

#include <limits>
#include <stop_token>

#include "core/segment/base/merge.hpp"
#include "core/segment/search/attach_small_charts.hpp"

namespace unwrapd::segment::search {

inline constexpr double kCostOfEmptiness = 40;  ///< of a whole page, in length of seams

struct PartitionCost {
  double seams = std::numeric_limits<double>::infinity();  ///< by seam_cost, and charts
  double all = std::numeric_limits<double>::infinity();    ///< and what the page leaves empty
  double length =
      std::numeric_limits<double>::infinity();  ///< of the seams; area of the surface: 1
};

struct CostRules {
  double chart = 0;        ///< what each chart costs, in length of seams
  double small_chart = 0;  ///< one below kSmallRegion: most of them can be hung on others
  double page_area = 1;    ///< of all that comes onto the page, in units of the surface's
  double wanted_fill = 1;  ///< share of the page; a page that is fuller costs nothing
  double limit = std::numeric_limits<double>::infinity();    ///< from here on it is all the same
  double longest = std::numeric_limits<double>::infinity();  ///< seams of which cost without limit
  double packing = 1;  ///< work of the rough packing, see pack::RoughRules
  std::stop_token stop = {};
};

/// The length of all seams; area of the surface: 1.
double seam_length(const SegmentationMesh& surface, const Partition& partition);

/// Seams by seam_cost, so much for each chart, and more for each share of a rough packing
/// that is wanted and left empty; nothing for what needs no cut. Where `all` is not below the limit
/// it may be infinite instead. Rounded: equal costs tie. Throws Error{cancelled}.
PartitionCost partition_cost(const SegmentationMesh& surface, const Partition& partition,
                             const CostRules& rules);

}  // namespace unwrapd::segment::search
