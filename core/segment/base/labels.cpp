#include "core/segment/base/labels.hpp"

#include <algorithm>
#include <utility>

#include "core/linear/sparse.hpp"
#include "core/mesh/topology.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kClearMajority = 1.0001;  // ties, and what rounding makes of them, move nothing

/// The faces around a face: those that share a vertex with it.
class Surroundings {
 public:
  explicit Surroundings(const SegmentationMesh& surface)
      : surface_(surface),
        corners_(linear::vertex_corners(surface.mesh.faces, surface.mesh.vertex_count())) {}

  template <class Visit>
  void for_each(Index t, Visit visit) const {
    for (const Index v : surface_.mesh.faces[t])
      for (Index k = corners_.begin[v]; k < corners_.begin[v + 1]; ++k)
        visit(face_of(corners_.corner[k]));
  }

 private:
  const SegmentationMesh& surface_;
  linear::VertexCorners corners_;
};

/// The label with most area around face t among faces turned alike; its own where none has clearly
/// more.
Index prevailing_label(const SegmentationMesh& surface, const Surroundings& around,
                       double least_cosine, const std::vector<Index>& label, Index t) {
  std::vector<std::pair<Index, double>> votes{{label[t], 0.0}};
  around.for_each(t, [&](Index other) {
    if (surface.normal[other].dot(surface.normal[t]) < least_cosine) return;
    auto vote = std::find_if(votes.begin(), votes.end(),
                             [&](const auto& v) { return v.first == label[other]; });
    if (vote == votes.end()) vote = votes.insert(votes.end(), {label[other], 0.0});
    vote->second += surface.area(other);
  });
  auto best = votes.front();
  for (const auto& vote : votes)
    if (vote.second > kClearMajority * best.second) best = vote;
  return best.first;
}

bool is_beside(const SegmentationMesh& surface, const std::vector<Index>& label, Index t,
               Index wanted, double least_cosine) {
  for (Index h = 3 * t; h < 3 * t + 3; ++h) {
    const Index twin = surface.halfedges.twin[h];
    if (twin != kNoTwin && label[face_of(twin)] == wanted &&
        surface.normal[face_of(twin)].dot(surface.normal[t]) >= least_cosine)
      return true;
  }
  return false;
}

}  // namespace

Index renumber(std::vector<Index>& label) {
  const Index most = label.empty() ? 0 : *std::max_element(label.begin(), label.end()) + 1;
  std::vector<Index> number(static_cast<std::size_t>(most), -1);
  Index count = 0;
  for (Index& l : label) {
    if (number[l] < 0) number[l] = count++;
    l = number[l];
  }
  return count;
}

std::vector<std::vector<Index>> faces_by_label(std::span<const Index> label, Index count) {
  std::vector<std::vector<Index>> faces(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < label.size(); ++t) faces[label[t]].push_back(static_cast<Index>(t));
  return faces;
}

void separate_labels(const Halfedges& halfedges, std::vector<Index>& label) {
  std::vector<Index> piece(label.size(), -1), open;
  Index count = 0;
  for (Index start = 0; start < static_cast<Index>(label.size()); ++start) {
    if (piece[start] >= 0) continue;
    piece[start] = count;
    open.assign(1, start);
    while (!open.empty()) {
      const Index t = open.back();
      open.pop_back();
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Index twin = halfedges.twin[h];
        if (twin == kNoTwin) continue;
        const Index other = face_of(twin);
        if (piece[other] >= 0 || label[other] != label[start]) continue;
        piece[other] = count;
        open.push_back(other);
      }
    }
    ++count;
  }
  label = std::move(piece);
}

void smooth_labels(const SegmentationMesh& surface, int passes, double least_cosine,
                   std::vector<Index>& label) {
  const Surroundings around(surface);
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<Index> before = label;
    for (Index t = 0; t < surface.face_count(); ++t) {
      const Index wanted = prevailing_label(surface, around, least_cosine, before, t);
      if (wanted != before[t] && is_beside(surface, label, t, wanted, least_cosine))
        label[t] = wanted;
    }
  }
  separate_labels(surface.halfedges, label);
}

}  // namespace unwrapd::segment
