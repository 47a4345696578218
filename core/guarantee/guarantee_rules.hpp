#pragma once
// The guarantee of a job as rules for one chart: what its map must have, and what a repair keeps.

#include <limits>

#include "core/charts/charts.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"
#include "core/types/options.hpp"

namespace unwrapd::guarantee {

/// The most rise of energy at which sheets that overlap are pressed apart: beyond it a short seam
/// is better.
inline constexpr double kMostPressed = 0.05;

/// What a chart's map must have, and how a repair may change the map.
struct GuaranteeRules {
  Guarantee guarantee = Guarantee::flip_free;
  RepairMethod repair = RepairMethod::untangle;
  /// Hard constraints stay; a chart with hard or soft ones is not split.
  solve::repair::MapIntent intent = {};
  /// A new map is refused, and the chart is split, if its energy above the least possible energy
  /// exceeds that of the old map by more than this share. At kMostPressed none is sought: sheets
  /// that cannot be pressed apart within it are cut.
  double most_rise = std::numeric_limits<double>::infinity();
  bool is_pressed = false;  ///< in vain; it would be so again
};

/// The rules for a chart's map under one lambda. The constraints, the executor and the solver's
/// system in the intent are left to the caller.
GuaranteeRules rules_for(const charts::Chart& chart, const solve::Disk& disk,
                         const UnwrapOptions& options, double lambda);

/// Whether the energy of uv rises further above that of `other` than the rules allow.
bool rises_too_far(const solve::Disk& disk, const GuaranteeRules& rules, const UvMap& uv,
                   const UvMap& other);

/// The relative rise of the method's own energy from one map to another; 0 where it fell.
double energy_rise(const solve::Disk& disk, const GuaranteeRules& rules, const UvMap& before,
                   const UvMap& now);

}  // namespace unwrapd::guarantee
