#pragma once
// Exact orientation tests in the plane.

#include <span>
#include <stop_token>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::measure {

/// The sign of the orientation of a, b, c: 1 counter-clockwise, -1 clockwise, 0 on one line. Exact
/// for all finite coordinates whose products neither overflow nor underflow (magnitudes between
/// 1e-140 and 1e150, and zero).
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

inline int orientation(const Triangle& face, std::span<const Vec2> uv) {
  const auto at = [&](int corner) { return uv[static_cast<std::size_t>(face[corner])]; };
  return orientation(at(0), at(1), at(2));
}

/// Faces whose image is not counter-clockwise, in ascending order: flipped, or of zero area.
/// Throws Error{cancelled}.
std::vector<Index> flipped_faces(std::span<const Triangle> faces, std::span<const Vec2> uv,
                                 const std::stop_token& stop = {});

}  // namespace unwrapd::measure
