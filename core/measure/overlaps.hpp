#pragma once
// Finds exactly where a map covers the plane more than once.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::measure {

inline constexpr std::size_t kMostPairs = 1 << 20;  ///< of overlapping triangles, that are counted

/// Whether the interiors of two triangles of the plane meet. Exact (see orientation()). A triangle
/// without area has no interior; a clockwise one counts as its mirror image.
bool overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b);

/// A sufficient test that no two triangles overlap, whose time depends on the boundary alone: no
/// face is flipped, every boundary loop is simple and touches no other, and one of them is
/// counter-clockwise. Then each point has as many preimages as loops wind around it, which is one
/// or none. False does not mean that there is an overlap.
bool is_plainly_injective(std::span<const Triangle> faces, std::span<const BoundaryLoop> loops,
                          std::span<const Vec2> uv, const std::stop_token& stop = {});

/// All pairs (s, t), s < t, of faces whose images overlap, in lexicographic order; at most `most`
/// of them. Near-linear for maps of ordinary triangles. Throws Error{cancelled}.
std::vector<std::array<Index, 2>> overlapping_pairs(std::span<const Triangle> faces,
                                                    std::span<const Vec2> uv, std::size_t most,
                                                    const std::stop_token& stop = {});

/// The same; loops: all boundary loops of the faces. If no face is flipped, only faces near the
/// boundary, or around which it winds more than once, are compared (winding.hpp).
std::vector<std::array<Index, 2>> overlapping_pairs(std::span<const Triangle> faces,
                                                    std::span<const BoundaryLoop> loops,
                                                    std::span<const Vec2> uv, std::size_t most,
                                                    const std::stop_token& stop = {});

}  // namespace unwrapd::measure
