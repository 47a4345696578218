#pragma once
// Conformal flattening by curvature prescription and metric scaling: one Poisson equation.

#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// Ben-Chen, Gotsman, Bunin 2008, without inner cones and with the lengths of the longest boundary
/// kept. energy: the greatest curvature left inside, radians, before and after the scaling.
/// Throws Error{solver_failed, cancelled}.
Solution cp(const Disk& disk, const SolveWatch& watch);

}  // namespace unwrapd::solve::methods
