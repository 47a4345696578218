#pragma once
// Charts that are painted to have more texels.

#include "core/charts/charts.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

/// Texels per unit of a chart whose painted value is 1, in those of one whose value is 0.
inline constexpr double kMostDensity = 4;

/// How many times the texels per unit of an unpainted chart this one gets: kMostDensity to the
/// power of the mean of Surface::texel_density over its area. 1 if nothing is painted, or
/// constraints determine the sizes of charts. surface: the chart's.
double density_of(const charts::Chart& chart, const Surface& surface, const UnwrapOptions& options);

}  // namespace unwrapd::pipeline
