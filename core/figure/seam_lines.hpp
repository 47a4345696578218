#pragma once
// The lines at which the charts of a surface end.

#include <vector>

#include "core/figure/painting.hpp"

namespace unwrapd::figure {

struct SeamLine {
  Edge edge;             ///< vertices of the UnwrappedSurface; source[] tells those of the mesh
  bool is_seam = false;  ///< the surface goes on beyond it; else it is a boundary of the surface
};

/// In the order of outline(). A seam has a line for each side of it.
std::vector<SeamLine> seam_lines(const Surface& surface, const UnwrappedSurface& unwrapped);

}  // namespace unwrapd::figure
