#pragma once
// A large surface as a small one of the same topology, on which charts are sought.

#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/edges.hpp"
#include "core/mesh/halfedges.hpp"

namespace unwrapd::segment {

/// Every vertex of the small surface stands for a cluster of vertices that hang together and lies
/// at their mean; each of its faces is the one face whose corners lie in the same three clusters.
struct Coarse {
  TriMesh mesh;
  Halfedges halfedges;         ///< of mesh.faces
  std::vector<Index> cluster;  ///< one a vertex of the large surface: the vertex that it became
  std::vector<Index> face;     ///< one a face: that of the large surface; corners keep their order
  std::span<const double> avoid = {};  ///< the large surface's, see charts::Chart; outlives this
};

/// The small surface's avoid: a cluster has the mean of the half-edges that start in it. An edge is
/// kept if one of those that join its two clusters is.
std::vector<double> coarse_avoid(const Coarse& coarse, const TriMesh& mesh,
                                 const Halfedges& halfedges);

/// Calls visit(h) for the half-edges of the large surface that join the two clusters of half-edge
/// `edge` of the small one, from the side of its face to that of the face across. is_core: one a
/// face of the large surface, 1: it is one of the small surface.
template <class Visit>
void for_each_of_strip(const Coarse& coarse, const TriMesh& mesh, const Halfedges& halfedges,
                       std::span<const char> is_core, Index edge, Visit visit) {
  const auto is_within = [&](Index h) {
    return coarse.cluster[start_of(mesh.faces, h)] == coarse.cluster[end_of(mesh.faces, h)];
  };
  for (Index h = 3 * coarse.face[face_of(edge)] + edge % 3;;) {
    visit(h);
    h = halfedges.twin[h];
    if (is_core[face_of(h)] != 0) return;
    h = next_halfedge(h);
    if (is_within(h)) h = next_halfedge(h);
  }
}

/// One a face of the large surface, 1: it is one of the small surface.
std::vector<char> core_faces(const Coarse& coarse, std::size_t faces);

/// Contracts edges until about `faces` are left, or no edge can go. mesh: connected, no face of
/// zero area, each vertex with one fan; genus and boundaries stay as they are, and so does the
/// result when the mesh is moved or scaled. avoid: see charts::Chart; the ends of kept edges stay
/// in different clusters, so that no seam that is transferred has to follow one. Throws
/// Error{cancelled}.
Coarse coarsen(const TriMesh& mesh, const Halfedges& halfedges, Index faces,
               const std::stop_token& stop, std::span<const double> avoid = {});

}  // namespace unwrapd::segment
