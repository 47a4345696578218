#pragma once
// Keeps the guarantee of one chart: repairs its map, and splits the chart where nothing else helps.

#include <memory>
#include <optional>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/guarantee/guarantee_rules.hpp"
#include "core/solve/base/disk.hpp"
#include "core/types/report.hpp"

namespace unwrapd::guarantee {

/// A chart, or one part of it, with its map.
struct GuaranteedPart {
  std::shared_ptr<const charts::Chart> chart;
  UvMap uv;  ///< in the units of the map that was handed in
};

struct GuaranteedMap {
  std::vector<GuaranteedPart> parts;  ///< one: the chart was not split
  Mending mending;
};

/// uv: the solved map of the chart's disk, in disk units. Afterwards no triangle of a part is
/// flipped (flip_free), and no two of a part overlap (bijective), by exact tests; under
/// Guarantee::none the map stays as it is. A chart with overlaps is pressed apart (press_apart())
/// or has a new map (map_injectively()), and is split where none is found within rules.most_rise.
/// The energy that mending.energy_rise tells of is intent.own, for angles D_angle; where it fell
/// the rise is 0, and of several parts it is the greatest. Throws Error{guarantee_failed}, where =
/// "/guarantee", where constraints leave no way, or a single triangle has no area in the map;
/// Error{cancelled}.
GuaranteedMap keep_guarantee(std::shared_ptr<const charts::Chart> chart, const solve::Disk& disk,
                             UvMap uv, const GuaranteeRules& rules);

/// What holds of the UVs that are written.
struct Written {
  Index flipped = 0;
  std::optional<Index> overlaps = {};  ///< pairs of triangles; not counted under Guarantee::none
};

/// Rounds a part's page UVs to numbers that every format writes exactly, and keeps the guarantee in
/// them. Vertices that rules.intent constrains are only rounded; under Guarantee::none all are.
/// Gaps that rounding closes are opened again (separate_rounded_boundaries()).
/// Throws Error{guarantee_failed, cancelled}.
Written keep_on_page(const charts::Chart& chart, const GuaranteeRules& rules, UvMap& page_uv);

}  // namespace unwrapd::guarantee
