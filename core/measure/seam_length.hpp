#pragma once
// How much seam an unwrapped surface has.

#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// 3D length of the edges between two faces whose UVs differ on both sides, mesh units. Edges are
/// found by position, so cuts that the input came with count as well; boundaries and non-manifold
/// edges do not.
double seam_length(const Surface& surface, const UnwrappedSurface& unwrapped);

/// The same by face: the length of each face's own sides that are seams. Adds up to twice
/// seam_length(). Throws Error{cancelled}.
std::vector<double> seam_lengths(const Surface& surface, const UnwrappedSurface& unwrapped,
                                 const std::stop_token& stop = {});

}  // namespace unwrapd
