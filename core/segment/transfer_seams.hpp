#pragma once
// Seams found on a small surface transferred to the large one that it stands for.

#include <span>
#include <stop_token>
#include <vector>

#include "core/segment/coarsen.hpp"

namespace unwrapd::segment {

struct TransferredSeams {
  Halfedges cut;            ///< of the large surface, opened along the seams
  std::vector<Index> near;  ///< one a face: a face of the small surface on the same side of seams
};

/// seam: one a half-edge of coarse, 1 on both sides of every edge along which it is opened; sides
/// without a twin may have either. Parts, genus and boundaries of what is left are the same on
/// both surfaces. Throws Error{cancelled}.
TransferredSeams transfer_seams(const TriMesh& mesh, const Halfedges& halfedges,
                                const Coarse& coarse, std::span<const char> seam,
                                const std::stop_token& stop);

}  // namespace unwrapd::segment
