#pragma once
// SLIM (Rabinovich, Poranne, Panozzo, Sorkine-Hornung, "Scalable Locally Injective Mappings", TOG
// 2017) for the symmetric Dirichlet energy: isometric as far as it goes, and never a flip.

#include "core/executor.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd {

/// The map of a local minimum of symmetric_dirichlet_energy(), which is what energy has: it never
/// rises, its least is 4. Every map on the way is free of flips. Ends when an iteration lowers the
/// energy by less than a millionth of it (converged) or after kMaxSlimIterations.
/// Throws Error{solver_failed} where no start without flips is found, and Error{cancelled}.
Solution slim(const Disk& disk, const SolveWatch& watch, Executor& executor);

inline constexpr int kMaxSlimIterations = 500;

}  // namespace unwrapd
