#pragma once
// Conformal flattening by curvature prescription and metric scaling: one Poisson equation.

#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// Ben-Chen, Gotsman, Bunin 2008, without inner cones; the longest boundary keeps its lengths.
/// energy: the greatest curvature that is left inside, radians, before and after the scaling.
/// Throws Error{solver_failed, cancelled}.
Solution cp(const Disk& disk, const SolveWatch& watch);

}  // namespace unwrapd::solve::methods
