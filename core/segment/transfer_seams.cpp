// Between the clusters of two neighbouring vertices of the small surface runs a strip of triangles,
// and every edge across the strip joins the two clusters. So a row of seams is a row of clusters to
// walk through, and its seams on the large surface are the shortest path (Dijkstra) that goes
// through the clusters in this order, crossing the strips between them (by seam_weight()). Clusters
// are disks: what meets in one makes a tree there, and the surface falls apart just as the small
// one did. Rejected: giving each face the label of the nearest small one and cutting where labels
// differ: slits have the same label on both sides, and labels fall to pieces.
#include "core/segment/transfer_seams.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/linear/sparse.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Seams of the small surface in a row, from one junction to the next.
using SeamRow = std::vector<Index>;

/// The small surface's seams in rows. Rows end at boundaries, too.
class SeamRows {
 public:
  SeamRows(const Coarse& coarse, std::span<const char> seam)
      : coarse_(coarse), seam_(seam), degree_(coarse.mesh.positions.size(), 0) {
    for (Index h = 0; h < count(); ++h) {
      if (coarse_.halfedges.twin[h] == kNoTwin)
        for (const Index v : {start(h), end(h)}) degree_[v] += kRim;
      else if (seam_[h] != 0)
        ++degree_[start(h)];  // the other end counts from the other side
    }
  }

  [[nodiscard]] std::vector<SeamRow> find() const {
    std::vector<SeamRow> rows;
    std::vector<char> taken(seam_.size(), 0);
    const auto take = [&](Index first) {
      SeamRow row;
      for (Index h = first; h != kNoTwin && taken[h] == 0; h = next(h)) {
        taken[h] = taken[coarse_.halfedges.twin[h]] = 1;
        row.push_back(h);
      }
      if (!row.empty()) rows.push_back(std::move(row));
    };
    for (Index h = 0; h < count(); ++h)
      if (is_inner_seam(h) && degree_[start(h)] != 2) take(h);
    for (Index h = 0; h < count(); ++h)  // what is left are rings without a junction
      if (is_inner_seam(h)) take(h);
    return rows;
  }

 private:
  static constexpr int kRim = 4;  // more than the two seams of a vertex that a row goes through

  [[nodiscard]] Index count() const { return static_cast<Index>(seam_.size()); }
  [[nodiscard]] Index start(Index h) const { return start_of(coarse_.mesh.faces, h); }
  [[nodiscard]] Index end(Index h) const { return end_of(coarse_.mesh.faces, h); }
  [[nodiscard]] bool is_inner_seam(Index h) const {
    return coarse_.halfedges.twin[h] != kNoTwin && seam_[h] != 0;
  }

  [[nodiscard]] Index next(Index h) const {
    if (degree_[end(h)] != 2) return kNoTwin;
    Index g = next_halfedge(h);
    while (seam_[g] == 0) g = next_halfedge(coarse_.halfedges.twin[g]);
    return g;
  }

  const Coarse& coarse_;
  std::span<const char> seam_;
  std::vector<int> degree_;  ///< seams at a vertex, and kRim for each boundary side
};

/// Walks rows of seams over the large surface.
class Tracing {
 public:
  Tracing(const TriMesh& mesh, const Halfedges& halfedges, const Coarse& coarse,
          const std::stop_token& stop)
      : mesh_(mesh),
        halfedges_(halfedges),
        twin_(halfedges.twin),
        coarse_(coarse),
        corners_(linear::vertex_corners(mesh.faces, mesh.vertex_count(), stop)),
        members_(mesh.positions.size()),
        rank_(members_.size()),
        strip_(twin_.size(), kNoTwin),
        on_seam_(members_.size(), 0),
        is_core_(core_faces(coarse, mesh.faces.size())),
        cut_(twin_.size(), 0) {
    for (Index v = 0; v < mesh.vertex_count(); ++v) members_[v] = v;
    counting_sort(
        members_, coarse.mesh.vertex_count(), [&](Index v) { return coarse.cluster[v]; }, stop);
    first_.assign(coarse.mesh.positions.size() + 1, 0);
    for (const Index c : coarse.cluster) ++first_[c + 1];
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    for (std::size_t k = 0; k < members_.size(); ++k)
      rank_[members_[k]] = static_cast<Index>(k) - first_[coarse.cluster[members_[k]]];
    for (Index h = 0; h < static_cast<Index>(twin_.size()); ++h)
      if (twin_[h] == kNoTwin) on_seam_[start(h)] = on_seam_[end(h)] = 1;
  }

  void trace(const SeamRow& row) {
    mark_strips(row);
    const std::vector<Index> clusters = clusters_of(row);
    if (clusters.front() == clusters.back() && !has_seam(clusters.front()))
      on_seam_[members_[first_[clusters.front()]]] = 1;
    walk(row, clusters);
  }

  [[nodiscard]] std::vector<char> take() { return std::move(cut_); }

 private:
  /// A vertex as often as the row comes through its cluster.
  struct Place {
    Index layer, vertex;
  };
  using Reached = std::pair<double, std::pair<Index, Index>>;

  [[nodiscard]] Index start(Index h) const { return start_of(mesh_.faces, h); }
  [[nodiscard]] Index end(Index h) const { return end_of(mesh_.faces, h); }
  [[nodiscard]] Index cluster(Index v) const { return coarse_.cluster[v]; }

  [[nodiscard]] bool has_seam(Index c) const {
    return std::any_of(members_.begin() + first_[c], members_.begin() + first_[c + 1],
                       [&](Index v) { return on_seam_[v] != 0; });
  }

  [[nodiscard]] std::vector<Index> clusters_of(const SeamRow& row) const {
    std::vector<Index> clusters{start_of(coarse_.mesh.faces, row.front())};
    for (const Index h : row) clusters.push_back(end_of(coarse_.mesh.faces, h));
    return clusters;
  }

  /// From the face of each seam across its strip to the face on the other side.
  void mark_strips(const SeamRow& row) {
    for (const Index seam : row)
      for_each_of_strip(coarse_, mesh_, halfedges_, is_core_, seam,
                        [&](Index h) { strip_[h] = strip_[twin_[h]] = seam; });
  }

  /// Marks the shortest path through the clusters, from a seam in the first to one in the last
  /// where there are some, else from and to anywhere in them.
  void walk(const SeamRow& row, const std::vector<Index>& clusters) {
    std::vector<Index> base{0};
    for (const Index c : clusters) base.push_back(base.back() + first_[c + 1] - first_[c]);
    const auto node = [&](const Place& at) { return base[at.layer] + rank_[at.vertex]; };
    std::vector<double> distance(static_cast<std::size_t>(base.back()), kFar);
    std::vector<Index> via(distance.size(), kNoTwin);
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
    const bool from_seam = has_seam(clusters.front()), to_seam = has_seam(clusters.back());
    for (Index k = first_[clusters.front()]; k < first_[clusters.front() + 1]; ++k) {
      if (from_seam && on_seam_[members_[k]] == 0) continue;
      distance[node({0, members_[k]})] = 0;
      open.push({0.0, {0, members_[k]}});
    }
    const auto last = static_cast<Index>(row.size());
    while (!open.empty()) {
      const auto [length_here, at] = open.top();
      const double d = length_here;  // Clang 14 lets no lambda capture what a binding names
      open.pop();
      const Place here{at.first, at.second};
      if (d > distance[node(here)]) continue;
      if (here.layer == last && (!to_seam || on_seam_[here.vertex] != 0))
        return mark(here, via, node);
      for_each_step(row, clusters, here, [&](Index h, const Place& there) {
        const double length = d + charts::seam_weight(coarse_.avoid, h) *
                                      (mesh_.positions[end(h)] - mesh_.positions[start(h)]).norm();
        if (!(length < distance[node(there)])) return;
        distance[node(there)] = length;
        via[node(there)] = h;
        open.push({length, {there.layer, there.vertex}});
      });
    }
  }

  template <class Visit>
  void for_each_step(const SeamRow& row, const std::vector<Index>& clusters, const Place& here,
                     Visit visit) const {
    for (Index k = corners_.begin[here.vertex]; k < corners_.begin[here.vertex + 1]; ++k) {
      const Index h = corners_.corner[k];
      if (twin_[h] == kNoTwin) continue;
      if (cluster(end(h)) == clusters[here.layer])
        visit(h, Place{here.layer, end(h)});
      else if (here.layer < static_cast<Index>(row.size()) && strip_[h] == row[here.layer])
        visit(h, Place{here.layer + 1, end(h)});
    }
  }

  template <class Node>
  void mark(Place at, const std::vector<Index>& via, Node node) {
    on_seam_[at.vertex] = 1;
    for (Index h = via[node(at)]; h != kNoTwin; h = via[node(at)]) {
      cut_[h] = cut_[twin_[h]] = 1;
      const bool crosses = cluster(start(h)) != cluster(end(h));
      at = {crosses ? at.layer - 1 : at.layer, start(h)};
      on_seam_[at.vertex] = 1;
    }
  }

  const TriMesh& mesh_;
  const Halfedges& halfedges_;
  const std::vector<Index>& twin_;
  const Coarse& coarse_;
  linear::VertexCorners corners_;
  std::vector<Index> members_, first_;  ///< vertices by cluster
  std::vector<Index> rank_;             ///< of a vertex in its cluster
  std::vector<Index> strip_;            ///< one a half-edge: the seam whose strip it crosses
  std::vector<char> on_seam_;           ///< one a vertex, 1: on a seam or boundary
  std::vector<char> is_core_;           ///< one a face, 1: it is one of the small surface
  std::vector<char> cut_;               ///< one a half-edge
};

/// From the faces that both surfaces have to all others on the same side of the cut.
class Spreading {
 public:
  Spreading(const Coarse& coarse, const std::stop_token& stop, TransferredSeams& transferred)
      : transferred_(transferred), stop_(stop) {
    transferred.near.assign(transferred.cut.twin.size() / 3, -1);
    for (std::size_t k = 0; k < coarse.face.size(); ++k) {
      transferred.near[coarse.face[k]] = static_cast<Index>(k);
      open_.push_back(coarse.face[k]);
    }
    spread();
  }

  /// A few faces that a ring of seams encloses, without one of the small surface: joined to what
  /// lies around them.
  void glue_what_is_left(const Halfedges& uncut) {
    for (Index h = 0; h < static_cast<Index>(uncut.twin.size()); ++h) {
      const Index twin = uncut.twin[h];
      if (twin == kNoTwin || transferred_.near[face_of(h)] < 0 ||
          transferred_.near[face_of(twin)] >= 0)
        continue;
      transferred_.cut.twin[h] = twin;
      transferred_.cut.twin[twin] = h;
      open_.assign(1, face_of(h));
      spread();
    }
  }

 private:
  void spread() {
    for (std::size_t k = 0; k < open_.size(); ++k) {
      check_cancelled_every(k, stop_);
      for (Index h = 3 * open_[k]; h < 3 * open_[k] + 3; ++h) {
        const Index twin = transferred_.cut.twin[h];
        if (twin == kNoTwin || transferred_.near[face_of(twin)] >= 0) continue;
        transferred_.near[face_of(twin)] = transferred_.near[open_[k]];
        open_.push_back(face_of(twin));
      }
    }
    open_.clear();
  }

  TransferredSeams& transferred_;
  const std::stop_token& stop_;
  std::vector<Index> open_;
};

}  // namespace

TransferredSeams transfer_seams(const TriMesh& mesh, const Halfedges& halfedges,
                                const Coarse& coarse, std::span<const char> seam,
                                const std::stop_token& stop) {
  Tracing tracing(mesh, halfedges, coarse, stop);
  for (const SeamRow& row : SeamRows(coarse, seam).find()) {
    throw_if_cancelled(stop);
    tracing.trace(row);
  }
  const std::vector<char> cut = tracing.take();
  TransferredSeams transferred{halfedges, {}};
  for (std::size_t h = 0; h < cut.size(); ++h)
    if (cut[h] != 0) transferred.cut.twin[h] = kNoTwin;
  Spreading(coarse, stop, transferred).glue_what_is_left(halfedges);
  return transferred;
}

}  // namespace unwrapd::segment
