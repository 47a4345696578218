#pragma once
// Where the seams of a partition run.

#include <vector>

#include "core/mesh/edges.hpp"
#include "core/segment/base/merge.hpp"

namespace unwrapd::segment::search {

/// Half-edges in a row, one of each edge; each begins where the one before it ends.
using Chain = std::vector<Index>;

/// The seams of a partition as it was when this was made; surface and partition must outlive it. A
/// half-edge is a seam where it is open, where another region lies across it, and at a boundary.
class SeamGraph {
 public:
  SeamGraph(const SegmentationMesh& surface, const Partition& partition);

  [[nodiscard]] Index twin(Index h) const { return surface_->halfedges.twin[h]; }
  [[nodiscard]] Index start(Index h) const { return start_of(surface_->mesh.faces, h); }
  [[nodiscard]] Index end(Index h) const { return end_of(surface_->mesh.faces, h); }

  /// The region of the face of h.
  [[nodiscard]] Index owner(Index h) const { return owner_[face_of(h)]; }

  /// How many seams meet in a vertex.
  [[nodiscard]] int degree(Index v) const { return degree_[v]; }

  [[nodiscard]] bool is_seam(Index h) const {
    return twin(h) == kNoTwin || partition_->open[h] != 0 || owner(h) != owner(twin(h));
  }
  /// Whether h is a seam with the same region on both sides.
  [[nodiscard]] bool is_slit(Index h) const {
    return twin(h) != kNoTwin && is_seam(h) && owner(h) == owner(twin(h));
  }

  /// The seams with faces on both sides, each once, in rows from one junction (or tip, or boundary)
  /// to the next: half-edges of the region of lower number. A ring without one is two rows.
  [[nodiscard]] std::vector<Chain> rows() const;

 private:
  [[nodiscard]] Index next(Index h) const;

  const SegmentationMesh* surface_;
  const Partition* partition_;
  std::vector<Index> owner_;
  std::vector<int> degree_;
};

}  // namespace unwrapd::segment::search
