#pragma once
// SLIM (Rabinovich, Poranne, Panozzo, Sorkine-Hornung, "Scalable Locally Injective Mappings", TOG
// 2017) for the symmetric Dirichlet energy: nearly isometric maps, never with a flip.

#include "core/base/executor.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::methods {

/// A local minimum of symmetric_dirichlet_energy(), whose least value is 4. Solution::energy has
/// its values, which never rise. No iterate has a flip. Ends after stop.iterations if that is set;
/// else when one iteration lowers the energy by no more than stop.tolerance of it, or when no step
/// lowers it (converged), or after stop.max_iterations. Throws Error{solver_failed} if no start
/// without flips is found, and Error{cancelled}.
Solution slim(const Disk& disk, const Stop& stop, const SolveWatch& watch, Executor& executor);

}  // namespace unwrapd::solve::methods
