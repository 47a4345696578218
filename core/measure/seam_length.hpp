#pragma once
// The length of the seams of an unwrapped surface.

#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::measure {

/// The twins of a mesh after vertices at one position are merged.
Halfedges halfedges_by_position(const TriMesh& mesh, const std::stop_token& stop = {});

/// 3D length of the edges between two faces whose UVs differ on both sides, mesh units. Edges are
/// found by position, so that cuts of the input count as well. Boundaries, non-manifold edges and
/// edges of faces without area on the page do not count.
double seam_length(const Surface& surface, const UnwrappedSurface& unwrapped);

/// The same by face: the length of each face's own sides that are seams. The sum is twice
/// seam_length(). Throws Error{cancelled}.
std::vector<double> seam_lengths(const Surface& surface, const UnwrappedSurface& unwrapped,
                                 const std::stop_token& stop = {});

/// The same, with by_position = halfedges_by_position() of the surface's mesh.
std::vector<double> seam_lengths(const TriMesh& mesh, const Halfedges& by_position,
                                 const UnwrappedSurface& unwrapped,
                                 const std::stop_token& stop = {});

}  // namespace unwrapd::measure
