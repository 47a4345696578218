#pragma once
// Texture coordinates of the faces that no chart has.

#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::pipeline {

inline constexpr Index kUncharted = -1;  ///< of a corner that shows no chart vertex

/// Gives every face in whole.set_aside its corners; at[face][corner] is a chart vertex, kUncharted
/// for exactly these faces. A duplicate shows what the face that it repeats shows. A degenerate
/// face gets no area: its corners go to the two ends of one edge that it shares with a charted
/// face, else to one point that a vertex of it shows. It keeps kUncharted where it touches no
/// chart. Throws Error{cancelled}.
void place_set_aside(const Surface& surface, const charts::Charts& whole,
                     const std::stop_token& stop, std::vector<Triangle>& at);

}  // namespace unwrapd::pipeline
