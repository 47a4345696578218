#pragma once
// A map of a whole disk in which no two triangles overlap.

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Replaces uv, one a vertex, by a map of little energy that is injective by an exact test, aligned
/// with uv or, if the intent has soft constraints, placed by them. Returns false and leaves uv as
/// it was if no injective map to start from was found: neither the one given, one a vertex, of any
/// scale (empty: none is), nor the mean-value nor Tutte's map is injective in double precision.
/// Throws Error{cancelled}.
bool map_injectively(const Disk& disk, const MapIntent& intent, UvMap& uv, const UvMap& given = {});

}  // namespace unwrapd::solve::repair
