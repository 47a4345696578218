#pragma once
// Patches of a map without flips, taken to little energy and kept free of flips and needles.

#include <span>

#include "core/solve/patch.hpp"
#include "core/solve/untangle.hpp"

namespace unwrapd {

/// Lowers the energy of intent.rigidity and the springs over the free vertices of a patch without
/// flips, under a barrier that fades. A little of the symmetric Dirichlet energy stays: without it
/// triangles that were turned over end as needles that dominate the distortion.
/// Throws Error{cancelled}.
void settle(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& uv);

/// Widens needles, triangles of a condition (sigma_max / sigma_min) beyond kMostCondition, among
/// the faces for which is_candidate is not 0: what is around them settles again under a higher
/// barrier, and again, until there are none or the barrier outweighs the energy. uv has no flips.
/// Throws Error{cancelled}.
void widen_needles(const Disk& disk, const MapIntent& intent, std::span<const char> is_candidate,
                   UvMap& uv);

inline constexpr double kMostCondition = 20;

}  // namespace unwrapd
