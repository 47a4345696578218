#include "core/pipeline/density.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace unwrapd::pipeline {

double painted_density(const charts::Chart& chart, const Surface& surface,
                       const UnwrapOptions& options) {
  if (surface.texel_density.empty() || !options.constraints.empty()) return 1;
  double sum = 0, area = 0;
  for (const Index t : chart.face_source) {
    const auto& [a, b, c] = surface.mesh.faces[static_cast<std::size_t>(t)];
    const auto position = [&](Index v) {
      return surface.mesh.positions[static_cast<std::size_t>(v)];
    };
    const auto value = [&](Index v) { return surface.texel_density[static_cast<std::size_t>(v)]; };
    const double own = (position(b) - position(a)).cross(position(c) - position(a)).norm();
    sum += own * (value(a) + value(b) + value(c)) / 3;
    area += own;
  }
  return area > 0 ? std::pow(kMostDensity, sum / area) : 1;
}

double density_of(const charts::Chart& chart, const Surface& surface,
                  const UnwrapOptions& options) {
  return options.constraints.empty() ? painted_density(chart, surface, options) * surface.scale : 1;
}

}  // namespace unwrapd::pipeline
