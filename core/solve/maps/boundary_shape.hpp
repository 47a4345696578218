#pragma once
// Maps the longest boundary loop of a chart to a circle or a square (Sec. 7: a fixed boundary).

#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve::maps {

/// The positions of all vertices of the longest loop, counter-clockwise, on the circle or the
/// square of area 1 about the origin, in disk units: UV area = 3D area. Positions follow arc length
/// along the whole circle, or along each side of the square. The square's corners are the vertices
/// nearest to the quarters of the loop, counted from its sharpest corner. A loop of three vertices
/// gets three of the corners. shape: circle or square.
std::vector<HardConstraint> boundary_points(const Disk& disk, BoundaryShape shape);

/// Whether an inner edge joins two vertices of one side of the square. The triangles that it cuts
/// off then have no area, and no map with that boundary is free of flips. points: on the square.
bool flattens_a_triangle(const Disk& disk, const std::vector<HardConstraint>& points);

}  // namespace unwrapd::solve::maps
