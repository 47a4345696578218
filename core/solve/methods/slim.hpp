#pragma once
// SLIM (Rabinovich, Poranne, Panozzo, Sorkine-Hornung, "Scalable Locally Injective Mappings", TOG
// 2017) for the symmetric Dirichlet energy: isometric as far as it goes, and never a flip.

#include "core/base/executor.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// The map of a local minimum of symmetric_dirichlet_energy(), which is what energy has: it never
/// rises, its least is 4. Every map on the way is free of flips. Ends after stop.iterations, where
/// given; else when one iteration lowers the energy by no more than stop.tolerance of it
/// (converged) or after stop.max_iterations. Where no step lowers the energy it has converged too.
/// Throws Error{solver_failed} where no start without flips is found, and Error{cancelled}.
Solution slim(const Disk& disk, const Stop& stop, const SolveWatch& watch, Executor& executor);

}  // namespace unwrapd::solve::methods
