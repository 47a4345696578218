#pragma once
// The guarantee kept for one chart: its map mended, and the chart split where nothing else helps.

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::guarantee {

/// A chart, whole or one part of it, with its map.
struct GuaranteedPart {
  std::shared_ptr<const charts::Chart> chart;
  UvMap uv;  ///< in the units of the map that was handed in
};

struct GuaranteedMap {
  std::vector<GuaranteedPart> parts;  ///< one: the chart was not split
  Mending mending;
};

/// What is promised, and how it may be kept.
struct GuaranteeRules {
  Guarantee guarantee = Guarantee::flip_free;
  RepairMethod repair = RepairMethod::untangle;
  solve::repair::MapIntent intent =
      {};  ///< hard constraints stay; a chart with hard or soft ones is not split
  /// What a new map's energy has above the least there is may be more by this share of what the old
  /// one's has; rather than that the chart is split.
  double most_rise = std::numeric_limits<double>::infinity();
};

/// uv: the solved map of the chart's disk, in disk units. Afterwards no triangle of a part is
/// flipped (flip_free), and no two of a part overlap (bijective), by exact tests; under
/// Guarantee::none the map stays as it is. A chart with overlaps has a new map (map_injectively()),
/// and is split only where none is found. The energy that mending.energy_rise tells of is
/// intent.own, for angles D_angle; where it fell the rise is 0. Throws Error{guarantee_failed},
/// where = "/guarantee", where constraints leave no way, or a single triangle has no area in the
/// map; Error{cancelled}.
GuaranteedMap keep_guarantee(std::shared_ptr<const charts::Chart> chart, const solve::Disk& disk,
                             UvMap uv, const GuaranteeRules& rules);

/// What is true of the UVs that are written.
struct Written {
  Index flipped = 0;
  std::optional<Index> overlaps = {};  ///< pairs of triangles; not counted under Guarantee::none
};

/// Rounds a kept part's page UVs to what every format writes exactly, and keeps the promise there;
/// vertices that rules.intent constrains are only rounded, and under Guarantee::none all are.
/// Gaps that rounding closes are opened again (separate_rounded_boundaries()).
/// Throws Error{guarantee_failed, cancelled}.
Written keep_on_page(const charts::Chart& chart, const GuaranteeRules& rules, UvMap& page_uv);

}  // namespace unwrapd::guarantee
