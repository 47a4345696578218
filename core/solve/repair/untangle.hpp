#pragma once
// Turns flipped triangles back at the least cost in energy (Sec. 4.4, last paragraph).

#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/solve/arap/global_step.hpp"
#include "core/solve/arap/local_step.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/solve/repair/profile.hpp"

namespace unwrapd::solve::repair {

/// The energy of a map, and what a repair must not move.
struct MapIntent {
  arap::Rigidity rigidity;        ///< the energy that shall rise least
  std::vector<char> constrained;  ///< one a vertex, 1: it must not move; empty: none
  std::stop_token stop;
  bool in_place = false;  ///< repair only near the flips, never by a new map of the whole disk
  int rings = 2;          ///< the first radius of patches around a flip; >= 1
  OwnEnergy own = OwnEnergy::fit;         ///< for a new map of the whole (bijective.hpp)
  std::vector<SoftConstraint> soft = {};  ///< weights as for rigidity
  Executor* executor = nullptr;           ///< repairs patches in parallel; null: none
  const arap::GlobalStep* global =
      nullptr;  ///< of the disk under its constraints; null: made when needed
};

/// Moves as few vertices as possible, near flipped or collapsed triangles (not counter-clockwise,
/// by the exact test), until there are none. Returns how many are left: more than zero only if hard
/// constraints or double precision allow no solution. The same map by any executor. Throws
/// Error{too_much_memory, cancelled}.
Index untangle(const Disk& disk, const MapIntent& intent, UvMap& uv);

/// A new map of the whole disk: scales start to the surface's area or, if there are soft
/// constraints, places it by them; then lowers its energy without a flip on the way. Returns false,
/// with uv as it was, if start has flips. Ignores hard constraints. Throws Error{cancelled}.
bool start_anew(const Disk& disk, const MapIntent& intent, UvMap start, UvMap& uv);

}  // namespace unwrapd::solve::repair
