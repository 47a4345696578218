#pragma once
// The flipped triangles of a whole disk turned over by the matrix of the global step, which is
// factored once.

#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Steps that turn_over_all() takes at most, each of one solve and one look at every face. A map
/// that was at rest under the method's energy takes 30 at most.
inline constexpr int kMostSplitSteps = 120;

/// Lowers the energy of intent.rigidity and the soft constraints, and a little of the symmetric
/// Dirichlet energy, over maps without flips; uv may have any. Held vertices stay. Few flips are
/// left on most maps, or none; nothing is promised. Returns the steps taken. The same bits by any
/// executor. Throws Error{solver_failed, too_much_memory, cancelled}.
int turn_over_all(const Disk& disk, const MapIntent& intent, UvMap& uv);

}  // namespace unwrapd::solve::repair
