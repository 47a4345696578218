#pragma once
// Charts of a surface of many faces, found on a small one that stands for it (ADR 0025).

#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/segment/segment.hpp"

namespace unwrapd::segment {

struct LargeCharts {
  std::vector<charts::Chart> charts;
  bool is_rough = false;  ///< noise leaves no room for the bound, which is then the small surface's
};

/// The component taken apart by segment(). The same for any executor. Throws Error{cancelled}.
LargeCharts large_charts(const charts::Chart& component, const SegmentRules& rules,
                         Executor& executor);

}  // namespace unwrapd::segment
