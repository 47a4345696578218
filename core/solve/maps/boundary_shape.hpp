#pragma once
// The longest boundary loop of a chart on a circle or a square (Sec. 7: a fixed boundary).

#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve::maps {

/// Every vertex of the longest loop, counter-clockwise, on the circle or the square of area 1 about
/// the origin, in disk units: UV area = 3D area. By arc length: along the whole circle, and along
/// each side of the square, whose corners are vertices (those nearest to the quarters of the loop,
/// counted from its sharpest corner). A loop of three vertices gets three of the square's corners.
/// shape: circle or square.
std::vector<HardConstraint> boundary_points(const Disk& disk, BoundaryShape shape);

/// Whether an edge inside the surface joins two vertices of one side of the square: what it cuts
/// off then has no area, and no map with that boundary is free of flips. points: of the square.
bool flattens_a_triangle(const Disk& disk, const std::vector<HardConstraint>& points);

}  // namespace unwrapd::solve::maps
