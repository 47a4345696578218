#pragma once
// A region as a mesh of its own, and the part of it that is mapped anew.

#include <span>
#include <vector>

#include "core/segment/base/segmentation_mesh.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::segment {

struct RegionMesh {
  TriMesh mesh;
  Halfedges halfedges;
  std::vector<BoundaryLoop> loops;
  std::vector<measure::RestTriangle> rest;  ///< one a face
  std::vector<Index> rank;                  ///< one a vertex: that of the surface's
};

/// open: one a half-edge of the surface, 1: not glued; empty: none.
RegionMesh region_mesh(const SegmentationMesh& surface, std::span<const char> open,
                       std::span<const Index> faces);

/// In one piece, with a boundary and without a handle: V - E + F is 2 less the boundaries.
bool is_disk(const RegionMesh& region);

/// Faces of a region of which all vertices move but those that others of its faces have, too.
struct MovingPart {
  std::vector<Index> faces;       ///< ascending
  std::vector<Index> vertices;    ///< in the surface's order of elimination
  std::vector<Triangle> corners;  ///< of the faces, as numbers in `vertices`
  solve::VertexConstraints held;  ///< where the map of the other faces has them
};

/// How many faces move where so many are new: they and a rim around them.
std::size_t moving_count(std::size_t new_count);

/// The faces behind the first `mapped` and a rim around them; the whole region where none is
/// mapped. uv: of the first, one a face: a map in which they hold together.
MovingPart moving_part(const RegionMesh& region, std::size_t mapped, std::span<const CornerUv> uv);

}  // namespace unwrapd::segment
