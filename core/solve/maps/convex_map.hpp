#pragma once
// Maps with the boundary on a circle and every inner vertex a convex combination of its neighbours.
// They have no flips if the triangulation is 3-connected (Tutte 1963, Floater 1997).

#include <span>

#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve::maps {

/// Equal weights. The longest boundary loop lies on the circle by arc length; vertices of other
/// loops are inner vertices.
UvMap tutte_map(const Disk& disk);

/// Mean-value weights (Floater 2003), otherwise as tutte_map().
UvMap mean_value_map(const Disk& disk);

/// The same with a given longest loop: boundary has all of its vertices, on a convex curve.
UvMap tutte_map(const Disk& disk, std::span<const HardConstraint> boundary);
UvMap mean_value_map(const Disk& disk, std::span<const HardConstraint> boundary);

}  // namespace unwrapd::solve::maps
