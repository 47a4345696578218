#pragma once
// The faces of a surface grouped into nearly flat, round patches: an over-segmentation to merge.

#include <stop_token>
#include <vector>

#include "core/segment/segmentation_mesh.hpp"

namespace unwrapd::segment {

/// One label a face, 0.. by first face; the faces of a label hang together. Within a patch the mean
/// of (1 - cosine of the angle to the patch's normal) stays below flatness, in (0, 2).
/// normals: one a face (those of the surface, or smoothed). Throws Error{cancelled}.
std::vector<Index> cluster_faces(const SegmentationMesh& surface, std::span<const Vec3> normals,
                                 double flatness, const std::stop_token& stop);

}  // namespace unwrapd::segment
