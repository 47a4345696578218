#pragma once
// A partition of a surface's faces as one label a face.

#include <cmath>
#include <span>
#include <vector>

#include "core/segment/base/segmentation_mesh.hpp"

namespace unwrapd::segment {

/// A cost with the last digits taken off: costs that differ by rounding alone tie, and ties are
/// broken by number, so that a mesh moved or scaled is taken apart in the same way.
inline double rounded(double cost) {
  int exponent = 0;
  const double share = std::frexp(cost, &exponent);
  return std::ldexp(std::round(share * 0x1p20), exponent - 20);
}

/// Labels become 0, 1, .. in the order of their first faces. Returns how many there are.
Index renumber(std::vector<Index>& label);

/// The faces of each label, ascending. label: 0..count-1.
std::vector<std::vector<Index>> faces_by_label(std::span<const Index> label, Index count);

/// Labels that do not hang together (across sides of triangles) come apart.
void separate_labels(const Halfedges& halfedges, std::vector<Index>& label);

/// Borders between labels made smoother: a face goes to the label that has most of the area around
/// it, `passes` times, where the faces that it joins are turned away from it by an angle of less
/// than that whose cosine is given. Labels then are separated and renumbered.
void smooth_labels(const SegmentationMesh& surface, int passes, double least_cosine,
                   std::vector<Index>& label);

}  // namespace unwrapd::segment
