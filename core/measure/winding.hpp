#pragma once
// The winding number of a map's boundary around its faces.

#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::measure {

/// For a map without flipped faces: all faces whose images may overlap another's, ascending. A
/// point on no edge has as many preimages as all loops together wind around it, so that a face
/// around which they wind once overlaps no other. Faces near the boundary are listed in any case.
/// loops: all boundary loops of the faces. Linear time. Throws Error{cancelled}.
std::vector<Index> faces_perhaps_overlapped(std::span<const Triangle> faces,
                                            std::span<const BoundaryLoop> loops,
                                            std::span<const Vec2> uv,
                                            const std::stop_token& stop = {});

}  // namespace unwrapd::measure
