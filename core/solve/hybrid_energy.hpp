#pragma once
// The energy of Hybrid for maps that were not solved for it.

#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve {

/// Triangles and their map, at any scale.
struct MappedFaces {
  std::span<const measure::RestTriangle> rest;  ///< in mesh units
  std::span<const Triangle> faces;
  std::span<const Vec2> uv;
};

/// Eq. (5) for each of the lambdas, over the surface area, of the map scaled to UV area = 3D area.
/// The same bits for any executor.
std::vector<double> hybrid_energies(const MappedFaces& map, std::span<const double> lambdas,
                                    LambdaUnits units, Executor& executor);

}  // namespace unwrapd::solve
