#pragma once
// What charts will come to when they are solved.

#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment {

struct ChartExcess {
  ExcessDistortion mean;        ///< over the area of all charts
  std::vector<double> of_each;  ///< worst() of each chart over its own area
};

/// The excess of charts after some iterations of ARAP from their starts; faces that are flipped or
/// collapsed then are left out. A chart that cannot be factored counts as flat. The same for any
/// executor. Throws Error{cancelled}.
ChartExcess chart_excess(std::span<const charts::Chart> charts, Executor& executor,
                         const std::stop_token& stop);

}  // namespace unwrapd::segment
