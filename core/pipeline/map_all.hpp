#pragma once
// All charts of a job, mapped one after another, or by several processes
// (core/base/shared_work.hpp).

#include <span>
#include <vector>

#include "core/pipeline/parameterize_chart.hpp"

namespace unwrapd::pipeline {

/// map_chart() of each, the same whoever makes them; progress is told in the order of the charts.
/// Throws what map_chart() throws.
std::vector<std::vector<std::vector<MappedChart>>> map_all(std::span<const ChartJob> jobs,
                                                           const UnwrapOptions& options,
                                                           ChartProgress& progress,
                                                           Executor& executor);

}  // namespace unwrapd::pipeline
