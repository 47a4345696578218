#pragma once
// Turns over the flipped triangles of a whole disk with the matrix of the global step, which is
// factored once.

#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// The most steps of turn_over_all(). Each takes one solve and one pass over the faces. A map that
/// was at rest under the method's energy takes 30 at most.
inline constexpr int kMostSplitSteps = 120;

/// Lowers the energy of intent.rigidity and the soft constraints, plus a little of the symmetric
/// Dirichlet energy, towards maps without flips; uv may have flips. Constrained vertices stay. Most
/// maps end with few flips or none, without a guarantee. Returns the number of steps. The same bits
/// for any executor. Throws Error{solver_failed, too_much_memory, cancelled}.
int turn_over_all(const Disk& disk, const MapIntent& intent, UvMap& uv);

}  // namespace unwrapd::solve::repair
