#pragma once
// Flipped triangles of a patch turned over by the regularised barrier.

#include <cstddef>
#include <span>

#include "core/solve/repair/barrier.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Turns the triangles of a patch over until none is flipped, or at most `enough` and a step no
/// longer halves them. Gives up where they do not grow fewer. Throws Error{cancelled}.
void turn_over(const BarrierMesh& patch, const MapIntent& intent, std::size_t enough, UvMap& uv);

/// Another start for what turn_over() left flipped: each free vertex goes most of the way to the
/// middle of its neighbours, a few times over. Throws Error{cancelled}.
UvMap evened_out(const BarrierMesh& patch, UvMap uv);

/// Whether every triangle is counter-clockwise by the exact test, with a positive determinant.
bool is_untangled(const BarrierMesh& mesh, std::span<const Vec2> uv);

}  // namespace unwrapd::solve::repair
