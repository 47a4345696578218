#pragma once
// Logarithmic scale factors that flatten a disk and are constant on its boundary, without factoring
// a system of their own.

#include <optional>
#include <span>
#include <vector>

#include "core/solve/arap/global_step.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::arap {

/// The tolerated variation of u on the boundary, relative to the variation under even fluxes.
inline constexpr double kLevel = 1.0 / 30;

/// u, one a vertex: L u = -curvature at inner vertices, to the accuracy of one solve, and constant
/// on the boundary up to kLevel (the mean is arbitrary). Empty if that takes more than `most`
/// solves. global: the system of the disk without constraints. Throws Error{cancelled}.
std::optional<std::vector<double>> even_boundary_scale_factors(const Disk& disk,
                                                               const GlobalStep& global,
                                                               std::span<const double> curvature,
                                                               int most);

}  // namespace unwrapd::solve::arap
