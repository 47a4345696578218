#pragma once
// Log scale factors that flatten a disk and are level on its boundary, without a system of their
// own.

#include <optional>
#include <span>
#include <vector>

#include "core/solve/arap/global_step.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::arap {

/// How uneven u may stay on the boundary: to what even fluxes through it would make of it.
inline constexpr double kLevel = 1.0 / 30;

/// u, one a vertex, with L u = -curvature at inner vertices, as exactly as one solve finds it, and
/// level on the boundary but for kLevel (its mean is of no consequence). Nothing where that takes
/// more than `most` solves. global: that of the disk without holds. Throws Error{cancelled}.
std::optional<std::vector<double>> even_boundary_scale_factors(const Disk& disk,
                                                               const GlobalStep& global,
                                                               std::span<const double> curvature,
                                                               int most);

}  // namespace unwrapd::solve::arap
