#pragma once
// Repairs flips locally by the convex virtual boundary, "without changing much else" (Sec. 4.4,
// last paragraph).

#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Takes patches around the flips from virtual_boundary_map(), which has none, fits them into the
/// rest of the map, and lets them settle. A patch that does not fit grows, in the end to the whole
/// disk. Returns whether any flip was repaired; the others stay. Constrained vertices never move.
/// Throws Error{cancelled}.
bool mend_by_virtual_boundary(const Disk& disk, const MapIntent& intent, UvMap& uv);

}  // namespace unwrapd::solve::repair
