#pragma once
// Parts the sheets of a map that lies on itself, from where they lie.

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Moves sheets that lie on each other apart until uv is injective by the exact test, at little
/// cost in the energy of intent.rigidity. Returns false, with uv as it was, if that would raise the
/// energy by more than the share most_rise, or if the sheets do not part: those that lie deep in
/// each other, or around each other. uv: one a vertex, without flips. Ignores constraints. The work
/// is bounded: some hundred iterations of ARAP. Throws Error{cancelled}.
bool press_apart(const Disk& disk, const MapIntent& intent, double most_rise, UvMap& uv);

}  // namespace unwrapd::solve::repair
