#pragma once
// From a surface as it came in to its connected components, topology repaired, and to charts that
// the solver takes: everything that is not a disk cut to one, or taken apart (segment_charts.hpp).

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
  UvMap start = {};  ///< a map of any scale to begin with, nearly free of flips; empty: none
  Guarantee least = Guarantee::none;  ///< what its map keeps unless nothing shall be guaranteed
  std::vector<char> crease = {};  ///< of a component, one a half-edge, 1: materials meet there, or
                                  ///< the input has vertices of their own on both sides
};

/// A surface taken apart. Faces in set_aside are in no chart.
struct Charts {
  std::vector<Chart> charts;     ///< ordered by their lowest face
  std::vector<Index> set_aside;  ///< faces of the surface: degenerate or duplicate, ascending
  std::vector<Index> repeats;    ///< one for each set aside: the face it duplicates, else -1
  InputReport input;             ///< of this surface
  std::vector<Repair> repairs;   ///< Repair::surface is left 0 for the caller to fill in
  std::shared_ptr<const Halfedges> by_position = {};  ///< of all faces, see seam_length.hpp
};

/// What opens a surface beside its boundaries.
struct SeamRules {
  SeamMode mode = SeamMode::automatic;   ///< uv0 is automatic for a surface without UVs
  std::span<const SeamPath> paths = {};  ///< of all surfaces
  Index surface = 0;                     ///< which of them this is
  std::stop_token stop = {};
  SharedCache* core = nullptr;  ///< shares what does not depend on places; null: none
};

void describe(CacheKey& key, const SeamRules& seams);

/// The components of a surface, which need not be disks: those that are none have yet to be cut or
/// taken apart, and may be without a loop; by_position is there. Throws Error{not_orientable}, and
/// Error{invalid_option} with where = "/seam_edges/<i>" where a path leaves the surface's vertices
/// or edges. Throws Error{cancelled}.
Charts components_of(const Surface& surface, const SeamRules& seams);

/// Bytes that keeping it takes.
std::size_t bytes_of(const Chart& chart);

/// Whether a component is a disk, holes allowed, by its loops and its Euler characteristic.
bool is_disk(const Chart& component);

/// Makes one disk of a component that is none: see cut_to_disk().
void cut(Chart& component);

/// The components, each that is no disk cut to one. Throws Error{not_orientable}.
Charts make_charts(const Surface& surface, SeamMode seams);

}  // namespace unwrapd::charts
