#pragma once
// Where a map covers the plane twice, exactly.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::measure {

/// Whether the interiors of two triangles of the plane meet. Exact (see orientation()). A triangle
/// of no area has no interior; one that is clockwise counts as its mirror image.
bool overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b);

/// A proof that no two triangles overlap, in time of the boundary alone: no face is flipped, every
/// boundary loop is simple and none touches another, and one of them is counter-clockwise. Then
/// each point has as many preimages as loops wind around it, and that is one or none. False means
/// only that this is no proof.
bool is_plainly_injective(std::span<const Triangle> faces, std::span<const BoundaryLoop> loops,
                          std::span<const Vec2> uv, const std::stop_token& stop = {});

/// All pairs (s, t), s < t, of faces whose images overlap, in lexicographic order; at most `most`
/// of them. Near-linear for maps of ordinary triangles. Throws Error{cancelled}.
std::vector<std::array<Index, 2>> overlapping_pairs(std::span<const Triangle> faces,
                                                    std::span<const Vec2> uv, std::size_t most,
                                                    const std::stop_token& stop = {});

/// The same; loops: all boundary loops of the faces. Where no face is flipped only those are
/// compared that the boundary comes near, or winds around more than once (winding.hpp).
std::vector<std::array<Index, 2>> overlapping_pairs(std::span<const Triangle> faces,
                                                    std::span<const BoundaryLoop> loops,
                                                    std::span<const Vec2> uv, std::size_t most,
                                                    const std::stop_token& stop = {});

}  // namespace unwrapd::measure
