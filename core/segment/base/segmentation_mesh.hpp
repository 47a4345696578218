#pragma once
// A connected surface as segmentation sees it: in units in which its area is 1, with what is asked
// again and again of its faces and sides worked out once.

#include <array>
#include <span>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/halfedges.hpp"

namespace unwrapd::segment {

struct SegmentationMesh {
  TriMesh mesh;         ///< recentred, area 1
  Halfedges halfedges;  ///< of mesh.faces; any genus, with or without boundaries
  std::vector<measure::RestTriangle> rest;  ///< one a face
  std::vector<Vec3> normal;                 ///< one a face, of unit length
  std::vector<double> length;               ///< one a half-edge, by charts::seam_weight()
  std::vector<double> seam_cost;  ///< one a half-edge: its length, but less along a crease
  std::vector<char> kept;   ///< one a half-edge, 1: no seam may run there; empty: may anywhere
  std::vector<Index> rank;  ///< of each vertex, in an order of elimination that fills little

  [[nodiscard]] Index face_count() const { return mesh.face_count(); }
  [[nodiscard]] double area(Index t) const { return rest[static_cast<std::size_t>(t)].area; }
};

/// mesh: connected, no face of zero area, each vertex with one fan. crease: one a half-edge, 1: a
/// seam shows less there; empty: none are given. Sharp edges are creases, too. Where many edges are
/// (each face of a flat-shaded export stands alone) they tell nothing, and none is. avoid: see
/// charts::Chart.
SegmentationMesh make_segmentation_mesh(const TriMesh& mesh, const Halfedges& halfedges,
                                        std::span<const char> crease = {},
                                        std::span<const double> avoid = {});

/// That of a component.
SegmentationMesh make_segmentation_mesh(const charts::Chart& component);

/// The faces projected along their mean normal: a seed for the map of a nearly flat set of faces.
std::vector<CornerUv> projected(const SegmentationMesh& surface, std::span<const Index> faces);

}  // namespace unwrapd::segment
