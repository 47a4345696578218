#pragma once
// Boundary First Flattening: first the curve that the boundary becomes, then the map inside it.

#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// Sawhney, Crane 2017, without a shape given: the boundary keeps its lengths, by which a conformal
/// map distorts areas least. energy: the conformal energy of the map, as ASAP's (asap_energy()).
/// Throws Error{solver_failed, cancelled}.
Solution bff(const Disk& disk, const SolveWatch& watch);

}  // namespace unwrapd::solve::methods
