#pragma once
// Connectivity as one array. Half-edge h = 3t + i is the directed side of face t from its corner i
// to corner i+1. twin[h] is the half-edge on the other side, or kNoTwin on a boundary or seam. All
// changes of topology (splitting a non-manifold edge, keeping a seam, cutting to a disk) only
// remove twins. Vertices are the classes of corners that twins connect.

#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

inline constexpr Index kNoTwin = -1;

inline Index next_halfedge(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
inline Index previous_halfedge(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
inline Index face_of(Index h) { return h / 3; }

struct Halfedges {
  std::vector<Index> twin;  ///< 3 * face_count entries
};

/// Pairs the half-edges (i,j) and (j,i) of the faces. An edge with more than two half-edges, or
/// with two of the same direction, gets no twins. Linear time (radix or counting sort).
Halfedges build_halfedges(std::span<const Triangle> faces, Index vertex_count,
                          const std::stop_token& stop = {});

/// A closed chain of twinless half-edges, in the order of a walk along the boundary with the
/// surface to the left. Each half-edge starts at the end of the one before.
using BoundaryLoop = std::vector<Index>;

/// All boundary loops, by their lowest half-edge.
std::vector<BoundaryLoop> boundary_loops(const Halfedges& halfedges,
                                         const std::stop_token& stop = {});

/// Sorts by descending 3D length; loops of equal length keep their order.
void sort_by_length(const TriMesh& mesh, std::vector<BoundaryLoop>& loops);

/// All boundary loops in descending 3D length (ties: the lowest half-edge). Needs manifold
/// vertices, as in a Chart: each vertex has one fan.
std::vector<BoundaryLoop> boundary_loops(const TriMesh& mesh, const Halfedges& halfedges,
                                         const std::stop_token& stop = {});

}  // namespace unwrapd
