#pragma once
// The area that a map covers on its page.

#include <span>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::measure {

/// Area of the triangles within [0,1]^2, wherever else they lie. Triangles on top of each other
/// count each.
double page_area(std::span<const Triangle> faces, std::span<const Vec2> uv);

}  // namespace unwrapd::measure
