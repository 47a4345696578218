#pragma once
// Makes winding consistent.

#include <stop_token>
#include <vector>

#include "core/mesh/weld_near.hpp"

namespace unwrapd {

/// turned[t] is 1 for the faces whose winding has to be reversed, so that neighbours agree across
/// all edges of two faces. Empty if there are none.
///
/// Faces that such edges connect are a group. A group whose faces agree already is left as it is,
/// and so is a one-sided one (a Moebius strip). Otherwise, the winding of three quarters of the
/// group's faces is kept. If neither winding has as many, a closed group is turned outward, and an
/// open one keeps the winding of most of its faces (of its first face in a tie).
/// Throws Error{cancelled}.
std::vector<char> faces_to_turn(const WeldedFaces& in, const std::stop_token& stop = {});

}  // namespace unwrapd
