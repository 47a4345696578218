#pragma once
// From a surface as it came in to charts that the solver takes: topology repaired, components
// separated, everything that is not a disk cut to one.

#include <vector>

#include "core/mesh/halfedges.hpp"
#include "core/mesh/topology.hpp"
#include "core/options.hpp"
#include "core/report.hpp"

namespace unwrapd {

/// A disk (holes allowed) cut from a surface: connected, manifold, orientable, no degenerate face.
struct Chart {
  TriMesh mesh;                     ///< positions as in the surface
  Halfedges halfedges;              ///< of mesh.faces
  std::vector<BoundaryLoop> loops;  ///< at least one, the longest first
  std::vector<Index> face_source;   ///< chart face -> face of the surface; corners keep their order
};

/// A surface taken apart. Faces in set_aside are in no chart.
struct Charts {
  std::vector<Chart> charts;     ///< ordered by their lowest face
  std::vector<Index> set_aside;  ///< faces of the surface: degenerate or duplicate, ascending
  std::vector<Index> repeats;    ///< one for each set aside: the face it duplicates, else -1
  InputReport input;             ///< of this surface
  std::vector<Repair> repairs;   ///< Repair::surface is left 0 for the caller to fill in
};

/// Throws Error{not_orientable}.
Charts make_charts(const Surface& surface, SeamMode seams);

}  // namespace unwrapd
