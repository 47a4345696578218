#pragma once
// All charts under one map, and the steps from their maps to the result.

#include <memory>
#include <span>
#include <vector>

#include "core/measure/distortion.hpp"
#include "core/pipeline/parameterize_chart.hpp"
#include "core/pipeline/prepare_charts.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::pipeline {

/// All charts under one map, which share their pages.
struct Layout {
  std::shared_ptr<const Prepared> all;  ///< what was mapped
  std::vector<std::vector<std::shared_ptr<const charts::Chart>>>
      charts;                               ///< of each surface, as mapped
  std::vector<std::vector<UvMap>> islands;  ///< islands[s][k]: the map of charts[s][k]
  std::vector<std::vector<std::vector<char>>> constrained;  ///< constrained[s][k]: see MappedChart
  measure::DistortionSums sums;  ///< of all charts, on the page as it is written
  Report report;
};

/// One layout for each map, still without charts; the reports have the input.
std::vector<Layout> empty_layouts(const std::shared_ptr<const Prepared>& all,
                                  std::size_t map_count);

void add_chart(Layout& layout, std::size_t surface, MappedChart mapped);

/// Notes how many charts have a new map in place of the method's own, and whether splits left more
/// charts than max_charts.
void note_new_maps(Layout& layout, const UnwrapOptions& options);

bool has_split_charts(const Layout& layout);

/// The length of all charts' borders in the scene, before charts are mapped, by
/// charts::seam_weight().
double border_of(const Prepared& all);

/// The same with those between the parts of split charts.
double border_of(const Layout& layout);

/// Packs all charts; their maps become page UVs. Charts under position constraints stay in place.
/// surfaces: those of the layout. Throws Error{does_not_fit, cancelled}.
void pack_charts(Layout& layout, std::span<const Surface> surfaces, const UnwrapOptions& options,
                 Executor& executor);

/// Rounds the page UVs to the numbers that are written, and keeps the guarantee in them. Throws
/// Error{guarantee_failed, cancelled}.
void quantize_maps(Layout& layout, const UnwrapOptions& options, const std::stop_token& stop);

/// Distortion and texel density of the triangles as they are written, rounding included. Densities
/// that were painted are in the texel density, and in no distortion. surfaces:
/// those that were unwrapped; given: the same as they came, with the positions that are written.
void measure_maps(Layout& layout, std::span<const Surface> surfaces, std::span<const Surface> given,
                  const UnwrapOptions& options, Executor& executor);

/// The surfaces with their UVs, and the complete report. Throws Error{cancelled}.
Unwrapped assemble_surfaces(std::span<const Surface> surfaces, Layout layout,
                            const UnwrapOptions& options, const std::stop_token& stop);

/// Gives every map's report the figures of all maps.
void report_curve(std::vector<Unwrapped>& maps, const std::vector<double>& lambdas);

}  // namespace unwrapd::pipeline
