#pragma once
// The sizes of triangles in a map, which energies that do not depend on size shall keep.

#include <span>
#include <vector>

#include "core/measure/rest_triangle.hpp"

namespace unwrapd::solve::repair {

/// Rigidities below this lambda (Rigidity) do not care about size.
inline constexpr double kConformalBelow = 0.01;

/// The stretch of each face and the faces around it: their geometric mean.
std::vector<double> sizes_around(std::span<const Triangle> faces,
                                 std::span<const measure::RestTriangle> rest,
                                 std::span<const Vec2> uv);

}  // namespace unwrapd::solve::repair
