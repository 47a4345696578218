#pragma once

#include <span>

#include "core/segment/base/segmentation_mesh.hpp"

namespace unwrapd::segment {

/// crease: as make_segmentation_mesh() takes it.
inline SegmentationMesh segmentation_mesh_of(const TriMesh& mesh,
                                             std::span<const char> crease = {}) {
  return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()), crease);
}

}  // namespace unwrapd::segment
