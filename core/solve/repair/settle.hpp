#pragma once
// Patches of a map without flips, taken to little energy and kept free of flips and needles.

#include <span>

#include "core/solve/repair/patch.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Lowers the energy of intent.rigidity and the soft constraints over the free vertices of a patch
/// without flips, under a barrier that fades. A little of the symmetric Dirichlet energy stays:
/// without it triangles that were turned over end as needles that dominate the distortion. own: the
/// map of the patch, by its own numbers. Throws Error{cancelled}.
void settle(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& own);

/// The same for patches of one map that share no triangle, side by side.
void settle_all(const Disk& disk, const MapIntent& intent, std::span<Patch> patches, UvMap& uv);

/// What a patch is worked on by: the executor where it is alone, else the calling thread.
inline MapIntent intent_of_one(MapIntent intent, std::size_t patches) {
  if (patches > 1) intent.executor = nullptr;
  return intent;
}

/// Widens needles, triangles of a condition (sigma_max / sigma_min) beyond kMostCondition, among
/// the faces for which is_candidate is not 0: what is around them settles again under a higher
/// barrier, and again, until there are none or the barrier outweighs the energy. uv has no flips.
/// Throws Error{cancelled}.
void widen_needles(const Disk& disk, const MapIntent& intent, std::span<const char> is_candidate,
                   UvMap& uv);

inline constexpr double kMostCondition = 20;

}  // namespace unwrapd::solve::repair
