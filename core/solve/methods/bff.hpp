#pragma once
// Boundary First Flattening: computes the boundary curve first, then the map inside it.

#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// Sawhney, Crane 2017, without a prescribed shape: the boundary keeps its lengths, which gives the
/// least area distortion of all conformal maps. energy: the conformal energy of the map
/// (asap_energy()). Throws Error{solver_failed, cancelled}.
Solution bff(const Disk& disk, const SolveWatch& watch);

}  // namespace unwrapd::solve::methods
