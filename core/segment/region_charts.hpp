#pragma once
// Regions of a surface as charts.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/segment/coarsen.hpp"
#include "core/segment/segment.hpp"

namespace unwrapd::segment {

/// In space.
double boundary_length(const charts::Chart& chart);

/// The same by charts::seam_weight().
double weighted_boundary(const charts::Chart& chart);

/// With the weighted boundaries of all charts for a length.
SeamsOfCharts seams_of(std::span<const charts::Chart> charts);

/// A chart of a component as one of its own, with what it has of the component's creases.
charts::Chart as_component(const charts::Chart& component, const charts::Chart& chart);

/// The rules for a component as they are for one of its charts.
SegmentRules rules_of_chart(SegmentRules rules, const charts::Chart& component,
                            const charts::Chart& chart);

/// The regions of a component, each with its map for a start.
std::vector<charts::Chart> region_charts(const charts::Chart& component, const Segments& segments);

/// The regions of the small surface that stands for a component, transferred to the component. The
/// starts follow the maps of the small surface: they may have flips where triangles are rough.
/// Throws Error{cancelled}.
std::vector<charts::Chart> region_charts(const charts::Chart& component, const Coarse& coarse,
                                         const Segments& segments, const std::stop_token& stop);

}  // namespace unwrapd::segment
