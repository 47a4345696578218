#pragma once
// Which faces go on into each other at an edge of more than two faces, by how they lie in space.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/edges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// Two half-edges, the lower first.
using HalfedgePair = std::array<Index, 2>;

/// The pairs across which a surface goes on without a crease, though more than two faces meet at
/// the edge: tiles of a floor under a wall. They run in opposite directions, the normals of their
/// faces are less than 30 degrees apart, and no other face of the edge lies nearly as flat to
/// either. Edges of more than 64 faces have none. areas: what inspect_areas() says of `welded`, the
/// faces over welded vertices. Ascending; a half-edge is in one pair at most. Throws
/// Error{cancelled}.
std::vector<HalfedgePair> flat_pairs(std::span<const Vec3> positions,
                                     std::span<const Triangle> welded,
                                     std::span<const FaceState> areas,
                                     const std::stop_token& stop = {});

}  // namespace unwrapd
