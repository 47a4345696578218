#pragma once
// Charts of a surface of many faces, found on a small one that stands for it (ADR 0025).

#include <optional>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/segment/base/search_extent.hpp"
#include "core/segment/segment.hpp"

namespace unwrapd::segment {

struct LargeCharts {
  std::vector<charts::Chart> charts;
  bool is_rough = false;  ///< noise leaves no room for the bound, which is then the small surface's
};

/// The component taken apart by segment(), on a small surface. The same for any executor. Throws
/// Error{cancelled}.
LargeCharts large_charts(const charts::Chart& component, const SegmentRules& rules,
                         const StandIn& small, Executor& executor);

/// The same where the bound holds for the component itself, at the first of its steps
/// (excess_steps()), so that no looser bound has another answer: else nothing.
std::optional<std::vector<charts::Chart>> large_charts_within_bound(const charts::Chart& component,
                                                                    const SegmentRules& rules,
                                                                    Index faces,
                                                                    Executor& executor);

}  // namespace unwrapd::segment
