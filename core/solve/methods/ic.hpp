#pragma once
// The inverse curvature map: from the curvature wanted back to the lengths that have it.

#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// Yang, Kim, Luo, Hu, Gu 2008: circles about the vertices grow and shrink until the metric that
/// they make is flat inside; those on the longest boundary keep their size, which distorts areas
/// least. Conformal for the circles' metric, which meets the mesh's own only where triangles are
/// acute. energy: the greatest curvature left inside, radians; 0 is flat.
/// Throws Error{solver_failed, cancelled}.
Solution ic(const Disk& disk, const SolveWatch& watch);

}  // namespace unwrapd::solve::methods
