#pragma once
// Turns flipped triangles of a patch over by the regularized barrier.

#include <cstddef>
#include <span>

#include "core/solve/repair/barrier.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Turns the triangles of a patch over until none is flipped, or at most `enough` are and a step no
/// longer halves them. Gives up if the flips do not become fewer. Throws Error{cancelled}.
void turn_over(const BarrierMesh& patch, const MapIntent& intent, std::size_t enough, UvMap& uv);

/// Another start for the flips that turn_over() left: moves each free vertex most of the way to the
/// mean of its neighbours, several times. Throws Error{cancelled}.
UvMap even_out(const BarrierMesh& patch, UvMap uv);

/// Whether every triangle is counter-clockwise by the exact test, with a positive determinant.
bool is_untangled(const BarrierMesh& mesh, std::span<const Vec2> uv);

}  // namespace unwrapd::solve::repair
