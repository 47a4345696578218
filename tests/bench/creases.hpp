#pragma once
// How much of an atlas's seams lies where it shows least.

#include <span>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// The share of the seams' length that lies where it shows least: at edges sharper than 38 degrees,
/// where materials meet, or where the input has vertices of its own on both sides. 0 without seams.
double share_on_creases(std::span<const Surface> surfaces,
                        std::span<const UnwrappedSurface> unwrapped);

}  // namespace unwrapd::bench
