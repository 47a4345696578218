#include "core/segment/search/seam_graph.hpp"

namespace unwrapd::segment::search {

SeamGraph::SeamGraph(const SegmentationMesh& surface, const Partition& partition)
    : surface_(&surface),
      partition_(&partition),
      owner_(owners(surface, partition)),
      degree_(surface.mesh.positions.size(), 0) {
  for (Index h = 0; h < static_cast<Index>(surface.length.size()); ++h) {
    if (!is_seam(h) || (twin(h) != kNoTwin && twin(h) < h)) continue;
    ++degree_[start(h)];
    ++degree_[end(h)];
  }
}

/// The seam that goes on from h where just two meet; kNoTwin at a junction and at a boundary.
Index SeamGraph::next(Index h) const {
  if (degree_[end(h)] != 2) return kNoTwin;
  Index g = next_halfedge(h);
  while (!is_seam(g)) g = next_halfedge(twin(g));
  return twin(g) == kNoTwin ? kNoTwin : g;
}

std::vector<Chain> SeamGraph::rows() const {
  std::vector<Chain> rows;
  std::vector<char> taken(surface_->length.size(), 0);
  const auto is_first = [&](Index h) {
    return twin(h) != kNoTwin && taken[h] == 0 && is_seam(h) && owner(h) <= owner(twin(h));
  };
  const auto take = [&](Index first) {
    Chain row;
    for (Index h = first; h != kNoTwin && taken[h] == 0; h = next(h)) {
      taken[h] = taken[twin(h)] = 1;
      row.push_back(h);
    }
    return row;
  };
  for (Index h = 0; h < static_cast<Index>(taken.size()); ++h)
    if (is_first(h) && degree_[start(h)] != 2) rows.push_back(take(h));
  for (Index h = 0; h < static_cast<Index>(taken.size()); ++h) {
    if (!is_first(h)) continue;
    const Chain ring = take(h);
    const auto half = ring.begin() + std::ssize(ring) / 2;
    rows.emplace_back(ring.begin(), half);
    rows.emplace_back(half, ring.end());
  }
  return rows;
}

}  // namespace unwrapd::segment::search
