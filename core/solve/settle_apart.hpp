#pragma once
// An injective map taken to little energy of a method's own, and kept injective.

#include <stop_token>

#include "core/solve/barrier.hpp"
#include "core/solve/disk.hpp"

namespace unwrapd {

/// Lowers the energy of rigidity, under barriers that fade between the boundaries and within the
/// triangles. uv must be injective by is_plainly_injective(), and still is afterwards.
/// Throws Error{cancelled}.
void settle_apart(const Disk& disk, const Rigidity& rigidity, const std::stop_token& stop,
                  UvMap& uv);

}  // namespace unwrapd
