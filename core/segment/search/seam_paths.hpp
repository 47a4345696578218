#pragma once
// Shorter ways for a row of seams.

#include "core/linear/sparse.hpp"
#include "core/segment/search/seam_graph.hpp"

namespace unwrapd::segment::search {

/// Finds ways between the ends of one row of seams, through the regions on its sides. What it
/// refers to must outlive it.
class SeamPaths {
 public:
  /// corners: of the surface's vertices (vertex_corners()). open: the partition's, but 0 along the
  /// row, so that ways may run along it.
  SeamPaths(const SegmentationMesh& surface, const linear::VertexCorners& corners,
            const SeamGraph& seams, const std::vector<char>& open, const Chain& row);

  /// The shortest way, by seam_cost, that meets no other seam, over vertices at most so many sides
  /// of triangles off the row; empty where none is shorter than `most`. It runs from the end of
  /// the row to its start, but each half-edge the other way.
  [[nodiscard]] Chain shortest(int corridor, double most) const;

 private:
  template <class Visit>
  void for_each_side(Index v, Visit visit) const;

  const SegmentationMesh& surface_;
  const linear::VertexCorners& corners_;
  const SeamGraph& seams_;
  const std::vector<char>& open_;
  Index from_, to_;
  std::vector<int> off_;  ///< of a vertex: sides off the row; -1: out of reach
};

}  // namespace unwrapd::segment::search
