#pragma once
// ASAP solved directly (Sec. 4.2): the least-squares conformal map.

#include <array>
#include <optional>
#include <span>

#include "core/solve/base/disk.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve::maps {

/// The map of least conformal energy, scaled so that UV area = 3D area.
/// Pins::diameter fixes the two boundary vertices that lie farthest apart in space (Sec. 4.2; Levy
/// et al. 2002). Pins::spectral fixes none: the smallest eigenvector that is not constant, under
/// unit norm on the boundary (Mullen, Tong, Alliez, Desbrun 2008). Throws Error{solver_failed}.
UvMap conformal_map(const Disk& disk, Pins pins);

/// The same without the cache, for a disk that is used once.
UvMap make_conformal_map(const Disk& disk, Pins pins);

/// The map of Pins::diameter, if double precision suffices for it. On ribbons a million times
/// longer than wide it does not; conformal_map() then returns a map that preserves angles but not
/// areas.
std::optional<UvMap> exact_conformal_map(const Disk& disk);

/// The two points of greatest distance, {a, b} with a < b. Exact, unless pruning leaves more than
/// some twenty million pairs (nearly spherical clouds of many thousand points). Then it is the best
/// pair found by then.
std::array<Index, 2> diameter(std::span<const Vec3> positions);

}  // namespace unwrapd::solve::maps
