#pragma once
// Lowers the energy of patches that have no flips, and keeps them free of flips and needles.

#include <span>

#include "core/solve/repair/patch.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Lowers the energy of intent.rigidity and the soft constraints over the free vertices of a patch
/// without flips, under a barrier that fades. A little of the symmetric Dirichlet energy stays:
/// without it triangles that were turned over end as needles that dominate the distortion. own: the
/// map of the patch, by its own numbers. Throws Error{cancelled}.
void settle(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& own);

/// The same for patches of one map that share no triangle, in parallel.
void settle_all(const Disk& disk, const MapIntent& intent, std::span<Patch> patches, UvMap& uv);

/// The intent for one of several patches: it uses the executor only if it is the only one.
inline MapIntent intent_of_one(MapIntent intent, std::size_t patches) {
  if (patches > 1) intent.executor = nullptr;
  return intent;
}

/// Widens needles, triangles of a condition (sigma_max / sigma_min) beyond kMostCondition, among
/// the faces with is_candidate != 0. Their surroundings settle again under rising barriers, until
/// no needle is left or the barrier outweighs the energy. uv has no flips. Throws Error{cancelled}.
void widen_needles(const Disk& disk, const MapIntent& intent, std::span<const char> is_candidate,
                   UvMap& uv);

inline constexpr double kMostCondition = 20;

}  // namespace unwrapd::solve::repair
