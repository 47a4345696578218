#pragma once
// What charts will come to when they are solved.

#include <span>
#include <stop_token>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/segment/test_parameterization.hpp"

namespace unwrapd::segment {

/// The excess of a chart after some iterations of ARAP from its start, in space: area * (D - 2).
/// The rest as for several.
ExcessDistortion excess_in_space(const charts::Chart& chart, Executor& executor,
                                 const std::stop_token& stop);

/// The excess of charts after some iterations of ARAP from their starts, over the area of all;
/// faces that are flipped or collapsed then are left out. A chart that cannot be factored counts as
/// flat. The same for any executor.
/// Throws Error{cancelled}.
ExcessDistortion chart_excess(std::span<const charts::Chart> charts, Executor& executor,
                              const std::stop_token& stop);

}  // namespace unwrapd::segment
