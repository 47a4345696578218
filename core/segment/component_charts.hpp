#pragma once
// The charts of one component within a bound of distortion.

#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/segment/segment.hpp"
#include "core/types/options.hpp"

namespace unwrapd::segment {

struct ComponentRules {
  SegmentRules segment;
  Symmetry symmetry = Symmetry::off;
  bool may_stay_whole = false;  ///< a disk that keeps the bound is one chart
};

struct ComponentCharts {
  std::vector<charts::Chart> charts;  ///< each with a start
  bool is_rough = false;              ///< its noise leaves no room for the bound
};

/// Of two bounds the tighter one never has shorter seams (ADR 0039, ADR 0066), unless it is rough.
/// The same for any executor. Throws Error{cancelled}.
ComponentCharts charts_within_bound(const charts::Chart& component, const ComponentRules& rules,
                                    Executor& executor);

}  // namespace unwrapd::segment
