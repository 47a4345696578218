#pragma once
// How many texels the charts of a page get for their lengths, beside each other.

#include "core/charts/charts.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

/// Texels per unit of a chart whose painted value is 1, in those of one whose value is 0.
inline constexpr double kMostDensity = 4;

/// How many times the texels per unit of an unpainted chart this one gets: kMostDensity to the
/// power of the mean of Surface::texel_density over its area. 1 if nothing is painted, or
/// constraints determine the sizes of charts. surface: the chart's.
double painted_density(const charts::Chart& chart, const Surface& surface,
                       const UnwrapOptions& options);

/// The same for each unit of the mesh, where scenes show it at Surface::scale. 1 under constraints.
double density_of(const charts::Chart& chart, const Surface& surface, const UnwrapOptions& options);

}  // namespace unwrapd::pipeline
