#pragma once
// A map of a whole disk in which no two triangles overlap.

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Replaces uv, one a vertex, by a map of little energy that is injective by an exact test, turned
/// and moved to where uv was or, where the intent has soft constraints, drawn by them. False, and
/// uv as it was, where no injective map to start from was found: neither the mean-value nor Tutte's
/// map is one in double precision. Throws Error{cancelled}.
bool map_injectively(const Disk& disk, const MapIntent& intent, UvMap& uv);

}  // namespace unwrapd::solve::repair
