#pragma once
// Half-edges sorted by edge, and the one rule by which two of them become twins. build_halfedges()
// and the seam modes use both.

#include <algorithm>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/mesh/halfedges.hpp"

namespace unwrapd {

/// A half-edge and its edge's ends, low < high.
struct EdgeSide {
  Index low = 0;
  Index high = 0;
  Index halfedge = 0;
};

/// The corners of a half-edge's face: where it starts, where it ends, the one that it faces.
inline Index start_of(std::span<const Triangle> faces, Index h) { return faces[h / 3][h % 3]; }
inline Index end_of(std::span<const Triangle> faces, Index h) {
  return start_of(faces, next_halfedge(h));
}
inline Index apex_of(std::span<const Triangle> faces, Index h) {
  return start_of(faces, previous_halfedge(h));
}

/// h as a side of its edge.
inline EdgeSide side_of(std::span<const Triangle> faces, Index h) {
  const auto [low, high] = std::minmax({start_of(faces, h), end_of(faces, h)});
  return {low, high, h};
}

inline bool repeats_vertex(const Triangle& face) {
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
}

/// The half-edges for which wanted(h) holds. Their ends must differ. Throws Error{cancelled}.
template <class Wanted>
std::vector<EdgeSide> edge_sides(std::span<const Triangle> faces, Wanted wanted,
                                 const std::stop_token& stop = {}) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * faces.size());
  for (Index h = 0; h < static_cast<Index>(3 * faces.size()); ++h) {
    check_cancelled_every(h, stop);
    if (wanted(h)) sides.push_back(side_of(faces, h));
  }
  return sides;
}

/// Sorts by edge, in linear time; sides on one edge keep the order of their half-edges. Throws
/// Error{cancelled}.
void sort_by_edge(std::vector<EdgeSide>& sides, Index vertex_count,
                  const std::stop_token& stop = {});

/// Pairs the sides of one edge, given as [first, last) of a sorted list. Two half-edges can be
/// twins if they run in opposite directions and their faces are not one triangle with both
/// orientations (in double-sided geometry each side is a sheet). They become twins if one of the
/// two has no other choice, and no third half-edge has one of them as its only choice. Returns the
/// number of pairs.
int pair_edge(std::span<const Triangle> faces, std::span<const EdgeSide> sides, Halfedges& out);

inline bool on_one_edge(const EdgeSide& a, const EdgeSide& b) {
  return a.low == b.low && a.high == b.high;
}

}  // namespace unwrapd
