#pragma once
// The inverse curvature map: from prescribed curvature to the lengths that have it.

#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// Yang, Kim, Luo, Hu, Gu 2008: circles about the vertices change their radii until their metric is
/// flat inside. Circles on the longest boundary keep their radii, which distorts areas least. The
/// map is conformal for the metric of the circles, which equals the mesh's own only if triangles
/// are acute. energy: the greatest curvature that is left inside, radians; 0 is flat. Throws
/// Error{solver_failed, cancelled}.
Solution ic(const Disk& disk, const SolveWatch& watch);

}  // namespace unwrapd::solve::methods
