#pragma once
// From the shapes of triangles to a map: the last step of every method that computes angles or edge
// lengths instead of coordinates.

#include <vector>

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::maps {

/// The map in which every triangle is as similar as possible to its entry in flat (Sec. 4.2 with
/// other reference triangles; one entry a face), scaled to UV area = 3D area. It is exact if the
/// triangles fit together in the plane. Otherwise the misfit is spread in least squares, where a
/// layout triangle by triangle would tear. Throws Error{solver_failed}.
UvMap lay_out(const Disk& disk, std::vector<measure::RestTriangle> flat);

/// Scales uv so that UV area = 3D area. Throws Error{solver_failed} if uv has no finite area.
void scale_to_area(const Disk& disk, UvMap& uv);

/// The rest triangle of edge lengths l[i] (from corner i to i+1), in any unit, the longest > 0.
/// Lengths that violate the triangle inequality are corrected: the longest stays, and the third
/// corner is raised to kMinHeight of it.
measure::RestTriangle triangle_of_lengths(const std::array<double, 3>& l);

/// The rest triangle of these angles (angle[i] at corner i, > 0), with area 1. The angles are
/// scaled to a sum of pi first; heights below kMinHeight are raised to it.
measure::RestTriangle triangle_of_angles(const std::array<double, 3>& angle);

}  // namespace unwrapd::solve::maps
