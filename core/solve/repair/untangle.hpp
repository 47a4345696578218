#pragma once
// Flipped triangles turned back, at the least cost in energy (Sec. 4.4, last paragraph).

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

/// What a map was made for, and what of it must stay.
struct MapIntent {
  arap::Rigidity rigidity;        ///< the energy whose rise shall be small
  std::vector<char> constrained;  ///< one a vertex, 1: it must not move; empty: none
  std::stop_token stop;
  bool in_place = false;           ///< only near the flips: never a new map of the whole disk
  int rings = 2;                   ///< how far around a flip vertices are let loose at first; >= 1
  OwnEnergy own = OwnEnergy::fit;  ///< of a new map of the whole (bijective.hpp)
  std::vector<SoftConstraint> soft = {};  ///< what draws vertices to places, weighed like rigidity
  Executor* executor = nullptr;           ///< on which patches are mended side by side; null: none
  const arap::GlobalStep* global =
      nullptr;  ///< of the disk under its constraints; null: made when needed
};

/// Moves the vertices near flipped or collapsed triangles (not counter-clockwise, by the exact
/// test) until there are none, as few as possible of them. Returns how many are left: above zero
/// only where hard constraints leave no way, or double precision none.
/// The same map by any executor.
/// Throws Error{too_much_memory, cancelled}.
Index untangle(const Disk& disk, const MapIntent& intent, UvMap& uv);

/// A new map of the whole disk: start, scaled to the surface's area or, where there are soft
/// constraints, taken to where they draw it; then taken to little energy without a flip on the way.
/// False, and uv as it was, where start has flips. Held vertices are not looked at. Throws
/// Error{cancelled}.
bool start_anew(const Disk& disk, const MapIntent& intent, UvMap start, UvMap& uv);

}  // namespace unwrapd::solve::repair
