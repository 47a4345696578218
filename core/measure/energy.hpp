#pragma once
// The energies of the paper, from the singular values of the map.

#include <span>

#include "core/measure/jacobian.hpp"

namespace unwrapd::measure {

/// Eq. (A2): sum of A_t [(sigma_max - 1)^2 + (sigma_min - 1)^2].
double arap_energy(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                   std::span<const Vec2> uv);

/// Eq. (2) with similarities: sum of A_t (sigma_max - sigma_min)^2 / 2. Eq. (A3) prints it without
/// the factor 1/2.
double asap_energy(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                   std::span<const Vec2> uv);

}  // namespace unwrapd::measure
