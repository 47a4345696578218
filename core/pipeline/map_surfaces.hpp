#pragma once
// From surfaces to the maps of all their charts.

#include <memory>
#include <span>
#include <vector>

#include "core/measure/distortion.hpp"
#include "core/pipeline/prepare_charts.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::pipeline {

/// All charts under one map: what goes on one page.
struct Layout {
  std::shared_ptr<const Prepared> all;  ///< what was mapped
  std::vector<std::vector<std::shared_ptr<const charts::Chart>>>
      charts;                               ///< of each surface, as mapped
  std::vector<std::vector<UvMap>> islands;  ///< islands[s][k]: the map of charts[s][k]
  std::vector<std::vector<std::vector<char>>> constrained;  ///< constrained[s][k]: see MappedChart
  measure::DistortionSums sums;  ///< of all charts, from space to the page as it is written
  Report report;
};

/// Takes the surfaces apart and maps every chart: a layout for each map (lambdas_of()). Where
/// charts are split to keep the guarantee, a tighter bound of distortion is taken if its seams are
/// shorter (ADR 0039). The same for any executor. Throws what prepare_charts() and
/// parameterize_chart() throw.
std::vector<Layout> map_surfaces(std::span<const Surface> surfaces, const UnwrapOptions& options,
                                 const Progress& progress, Executor& executor);

}  // namespace unwrapd::pipeline
