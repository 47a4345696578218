#pragma once

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// Twice the area of the triangle 0, a, b: above 0 where b lies to the left of a.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace unwrapd
