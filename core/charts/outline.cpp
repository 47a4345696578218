#include "core/charts/outline.hpp"

#include "core/measure/orientation.hpp"
#include "core/mesh/cross.hpp"

namespace unwrapd::charts {

Outline outline_of(const Chart& chart, std::span<const Vec2> uv) {
  Outline outline;
  const auto corner = [&](Index face, std::size_t i) {
    return uv[static_cast<std::size_t>(chart.mesh.faces[static_cast<std::size_t>(face)][i])];
  };
  const auto add = [&](Index h) {
    const auto i = static_cast<std::size_t>(h % 3);
    outline.push_back({corner(face_of(h), i), corner(face_of(h), (i + 1) % 3)});
  };
  for (const BoundaryLoop& loop : chart.loops)
    for (Index h : loop) add(h);
  for (Index t : measure::flipped_faces(chart.mesh.faces, uv))
    for (Index h = 3 * t; h < 3 * t + 3; ++h) add(h);
  return outline;
}

UvMap points_of(std::span<const std::array<Vec2, 2>> outline) {
  UvMap points;
  points.reserve(outline.size());
  for (const auto& [a, b] : outline) points.push_back(a);
  return points;
}

std::pair<Vec2, Vec2> bounds_of(const Outline& outline) {
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (const auto& [a, b] : outline) {
    low = low.cwiseMin(a);
    high = high.cwiseMax(a);
  }
  return {low, high};
}

double area_of(const Outline& outline) {
  double twice = 0;
  for (const auto& [a, b] : outline) twice += cross(a, b);
  return twice / 2;
}

}  // namespace unwrapd::charts
