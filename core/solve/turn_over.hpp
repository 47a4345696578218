#pragma once
// Flipped triangles of a patch turned over by the regularised barrier.

#include <cstddef>
#include <span>

#include "core/solve/barrier.hpp"
#include "core/solve/untangle.hpp"

namespace unwrapd {

/// Turns the triangles of a patch over until none is flipped, or at most `enough` and a step no
/// longer halves them. Gives up where they do not grow fewer. Throws Error{cancelled}.
void turn_over(const BarrierMesh& patch, const MapIntent& intent, std::size_t enough, UvMap& uv);

/// Whether every triangle is counter-clockwise by the exact test, with a positive determinant.
bool is_untangled(const BarrierMesh& mesh, std::span<const Vec2> uv);

}  // namespace unwrapd
