#pragma once
// How often the boundary of a map winds around its faces.

#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::measure {

/// Of a map without flipped faces: all faces whose images may overlap another's, ascending. A point
/// that no edge passes has as many preimages as the loops together wind around it, so a face around
/// all of which they wind once shares no point with another. Those near the boundary are listed
/// whether they overlap or not. loops: all boundary loops of the faces. Linear time. Throws
/// Error{cancelled}.
std::vector<Index> faces_perhaps_overlapped(std::span<const Triangle> faces,
                                            std::span<const BoundaryLoop> loops,
                                            std::span<const Vec2> uv,
                                            const std::stop_token& stop = {});

}  // namespace unwrapd::measure
