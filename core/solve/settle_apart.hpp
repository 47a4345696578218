#pragma once
// An injective map taken to little energy of a method's own, and kept injective.

#include "core/solve/disk.hpp"
#include "core/solve/untangle.hpp"

namespace unwrapd {

/// Lowers the energy of the intent's rigidity and springs, under barriers that fade between the
/// boundaries and within the triangles. uv must be injective by is_plainly_injective(), and still
/// is afterwards. Throws Error{cancelled}.
void settle_apart(const Disk& disk, const MapIntent& intent, UvMap& uv);

}  // namespace unwrapd
