#pragma once
// From an input surface to its connected components with repaired topology, and to charts for the
// solver: a component that is not a disk is cut to one, or split (segment_charts.hpp).

#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/shared_cache.hpp"
#include "core/mesh/halfedges.hpp"
#include "core/mesh/topology.hpp"
#include "core/types/cache_key.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::charts {

/// A disk (holes allowed) cut from a surface: connected, manifold, orientable, no degenerate face.
struct Chart {
  TriMesh mesh;                     ///< positions as in the surface
  Halfedges halfedges;              ///< of mesh.faces
  std::vector<BoundaryLoop> loops;  ///< at least one, the longest first
  std::vector<Index> face_source;   ///< chart face -> face of the surface; corners keep their order
  UvMap start = {};  ///< a map of any scale to start from, nearly free of flips; empty: none
  Guarantee least =
      Guarantee::none;            ///< the guarantee of this chart, unless options.guarantee is none
  std::vector<char> crease = {};  ///< of a component, one a half-edge: 1 where materials meet, or
                                  ///< where the input has separate vertices on both sides
  std::vector<double> avoid = {};  ///< one a half-edge, the same on both sides of an edge: the mean
                                   ///< of Surface::seam_avoid at its corners; of a kept edge,
                                   ///< kKept; empty: not painted and none kept
};

/// The result of preparing a surface. Faces in set_aside are in no chart.
struct Charts {
  std::vector<Chart> charts;     ///< ordered by their lowest face
  std::vector<Index> set_aside;  ///< faces of the surface: degenerate or duplicate, ascending
  std::vector<Index> repeats;   ///< one for each in set_aside: the face that it duplicates, else -1
  InputReport input;            ///< of this surface
  std::vector<Repair> repairs;  ///< the caller fills in Repair::surface
  std::shared_ptr<const Halfedges> by_position = {};  ///< of all faces, see seam_length.hpp
  double scale = 1;                                   ///< Surface::scale
};

/// The seams of a surface in addition to its boundaries.
struct SeamRules {
  SeamMode mode = SeamMode::automatic;   ///< uv0 means automatic for a surface without UVs
  std::span<const SeamPath> paths = {};  ///< of all surfaces
  Index surface = 0;                     ///< the number of this surface
  std::stop_token stop = {};
  SharedCache* core = nullptr;          ///< shares what does not depend on positions; null: none
  std::span<const SeamPath> kept = {};  ///< edges of all surfaces that no cut may follow
};

void describe(CacheKey& key, const SeamRules& seams);

/// The components of a surface, with by_position. A component need not be a disk, and may have no
/// loop; the caller cuts or splits it. Throws Error{not_orientable, cancelled}, and
/// Error{invalid_option} with where = "/seam_edges/<i>" or "/keep_edges/<i>" if a path leaves the
/// surface's vertices or edges, or a kept edge is in seam_edges, too.
Charts components_of(const Surface& surface, const SeamRules& seams);

/// The bytes of memory that a chart takes.
std::size_t bytes_of(const Chart& chart);

/// Whether a component is a disk, holes allowed, by its loops and its Euler characteristic.
bool is_disk(const Chart& component);

/// Cuts a component that is not a disk to one disk: see cut_to_disk().
void cut(Chart& component);

/// The components, cut to disks. Throws Error{not_orientable}.
Charts make_charts(const Surface& surface, SeamMode seams);

}  // namespace unwrapd::charts
