#pragma once
// A large surface as a small one of the same topology, on which charts are sought.

#include <span>
#include <stop_token>
#include <vector>

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

/// The small surface's avoid: a cluster has the mean of the half-edges that start in it.
std::vector<double> coarse_avoid(const Coarse& coarse, const TriMesh& mesh);

/// Contracts edges until about `faces` are left, or no edge can go. mesh: connected, no face of
/// zero area, each vertex with one fan; genus and boundaries stay as they are, and so does the
/// result when the mesh is moved or scaled. Throws Error{cancelled}.
Coarse coarsen(const TriMesh& mesh, const Halfedges& halfedges, Index faces,
               const std::stop_token& stop);

}  // namespace unwrapd::segment
