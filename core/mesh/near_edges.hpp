#pragma once
// Open edges that lie along each other: where a surface is meant to go on, but its vertices were
// written with rounding.

#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/edges.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// An edge of a single face. Vertices are welded ones, see weld().
struct OpenEdge {
  Index low = 0;
  Index high = 0;
  Index apex = 0;  ///< the third vertex of its face
};

/// Two open edges whose ends are near each other.
struct NearPair {
  std::size_t first = 0;  ///< edges: places in the list of open edges, first < second
  std::size_t second = 0;
  double distance = 0;      ///< between the ends that are further apart, mesh units
  bool is_crossed = false;  ///< the low end of one is at the high end of the other
};

/// The edges with one side. sides: sorted by edge.
std::vector<OpenEdge> open_edges(std::span<const Triangle> welded,
                                 const std::vector<EdgeSide>& sides, const std::stop_token& stop);

/// How far the ends of an edge's partner may be: a quarter of the edge's length.
inline constexpr double kReach = 0.25;

/// All pairs whose ends are within `reach` (mesh units) and within kReach of the shorter edge.
/// Faces that lie on each other (the two sides of a thin wall) and edges that a face joins are no
/// pairs. Each edge is compared with the 16 whose midpoints are nearest. Throws Error{cancelled}.
std::vector<NearPair> near_pairs(std::span<const Vec3> positions, std::span<const OpenEdge> edges,
                                 double reach, const std::stop_token& stop);

}  // namespace unwrapd
