// Edge contraction (Hoppe et al., "Mesh Optimization", 1993) as clustering of vertices: an edge
// costs what Ward (1963) takes for joining two clusters, the rise of their variance, so clusters
// stay round and of one size, and at their means noise averages out. An edge goes only where the
// link condition holds (Dey, Edelsbrunner et al. 1999), so that every cluster is a disk: that is
// what lets seams be carried back whatever their topology (transfer_seams.hpp). Sweeps under a
// rising threshold take the place of a queue. Rejected: quadric errors (Garland, Heckbert 1997),
// which follow noise; clusters by nearest seeds, whose dual need not be a surface.
#include "core/segment/coarsen.hpp"

#include <cmath>
#include <limits>

#include "core/base/cancel.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/base/labels.hpp"

namespace unwrapd::segment {
namespace {

constexpr int kMostSweeps = 80;
constexpr double kRise = 1.5;  // of the threshold, from sweep to sweep
constexpr Index kContractionsBetweenLooks = 4096;
constexpr Index kDead = -1;

class Contraction {
 public:
  Contraction(const TriMesh& mesh, const Halfedges& halfedges, std::span<const double> avoid,
              const std::stop_token& stop)
      : faces_(mesh.faces),
        twin_(halfedges.twin),
        kept_(halfedges.twin.size(), 0),
        face_count_(mesh.face_count()),
        out_(mesh.positions.size(), kDead),
        into_(out_.size()),
        area_(out_.size(), 0.0),
        middle_(mesh.positions),
        stamp_(out_.size(), -1) {
    for (Index v = 0; v < mesh.vertex_count(); ++v) into_[v] = v;
    for (Index h = 0; h < 3 * face_count_; ++h) {
      out_[start(h)] = h;
      kept_[h] = charts::is_kept(avoid, h) ? 1 : 0;
    }
    for (std::size_t t = 0; t < faces_.size(); ++t) {
      check_cancelled_every(t, stop);
      const Triangle& face = faces_[t];
      const double share = face_normal(face).norm() / 6;
      for (const Index v : face) area_[v] += share;
      total_ += 3 * share;
    }
  }

  void run(Index enough, const std::stop_token& stop) {
    const double mean = 2 * total_ / static_cast<double>(face_count_);
    double most = mean * mean / 2;  // what joining two vertices of mean area costs
    for (int sweep = 0; sweep < kMostSweeps && face_count_ > enough; ++sweep, most *= kRise)
      for (Index v = 0; v < static_cast<Index>(out_.size()) && face_count_ > enough; ++v) {
        if (v % kContractionsBetweenLooks == 0) throw_if_cancelled(stop);
        if (out_[v] != kDead) contract_at(v, most);
      }
  }

  [[nodiscard]] Coarse result() const {
    Coarse coarse;
    std::vector<Index> vertex(out_.size(), kDead), rank(faces_.size(), kDead);
    for (std::size_t v = 0; v < out_.size(); ++v) {
      if (out_[v] == kDead) continue;
      vertex[v] = coarse.mesh.vertex_count();
      coarse.mesh.positions.push_back(middle_[v]);
    }
    for (Index t = 0; t < static_cast<Index>(faces_.size()); ++t) {
      const auto& [a, b, c] = faces_[t];
      if (a == kDead) continue;
      rank[t] = coarse.mesh.face_count();
      coarse.mesh.faces.push_back({vertex[a], vertex[b], vertex[c]});
      coarse.face.push_back(t);
    }
    for (const Index t : coarse.face)
      for (Index h = 3 * t; h < 3 * t + 3; ++h)
        coarse.halfedges.twin.push_back(
            twin_[h] == kNoTwin ? kNoTwin : 3 * rank[face_of(twin_[h])] + twin_[h] % 3);
    coarse.cluster.reserve(into_.size());
    for (Index v = 0; v < static_cast<Index>(into_.size()); ++v)
      coarse.cluster.push_back(vertex[root_of(v)]);
    return coarse;
  }

 private:
  [[nodiscard]] Index start(Index h) const { return start_of(faces_, h); }
  [[nodiscard]] Index end(Index h) const { return end_of(faces_, h); }

  [[nodiscard]] Index root_of(Index v) const {
    while (into_[v] != v) v = into_[v];
    return v;
  }

  [[nodiscard]] Vec3 face_normal(const Triangle& face) const {
    return normal_of(middle_[face[0]], middle_[face[1]], middle_[face[2]]);
  }

  /// Calls visit(h) for every half-edge that starts in v. True where v is on a boundary.
  template <class Visit>
  bool for_each_out(Index v, Visit visit) const {
    const Index first = out_[v];
    Index h = first;
    while (true) {
      visit(h);
      h = twin_[previous_halfedge(h)];
      if (h == first) return false;
      if (h == kNoTwin) break;
    }
    for (h = twin_[first]; h != kNoTwin; h = twin_[next_halfedge(h)]) visit(next_halfedge(h));
    return true;
  }

  /// Calls visit(other) for every edge at v. True where v is on a boundary.
  template <class Visit>
  bool for_each_neighbour(Index v, Visit visit) const {
    return for_each_out(v, [&](Index h) {
      visit(end(h));
      if (twin_[previous_halfedge(h)] == kNoTwin) visit(start(previous_halfedge(h)));
    });
  }

  [[nodiscard]] double cost(Index v, Index w) const {
    return rounded(area_[v] * area_[w] / (area_[v] + area_[w]) *
                   (middle_[v] - middle_[w]).squaredNorm());
  }

  [[nodiscard]] Vec3 joint_middle(Index v, Index w) const {
    return (area_[v] * middle_[v] + area_[w] * middle_[w]) / (area_[v] + area_[w]);
  }

  void contract_at(Index v, double most) {
    Index best = kDead;
    double least = std::numeric_limits<double>::infinity();
    for_each_out(v, [&](Index h) {
      if (kept_[h] != 0) return;
      const double own = cost(v, end(h));
      if (own > most || own > least || (own == least && end(h) > end(best))) return;
      least = own;
      best = h;
    });
    if (best != kDead && keeps_topology(best) && keeps_sides(best)) contract(best);
  }

  /// Whether just the corners across the edge are neighbours of both of its ends.
  [[nodiscard]] bool keeps_topology(Index h) {
    const Index v = start(h), w = end(h);
    ++now_;
    const bool w_is_rim = for_each_neighbour(w, [&](Index other) { stamp_[other] = now_; });
    int common = 0;
    const bool v_is_rim =
        for_each_neighbour(v, [&](Index other) { common += stamp_[other] == now_ ? 1 : 0; });
    const bool is_inner = twin_[h] != kNoTwin;
    if (is_inner && v_is_rim && w_is_rim) return false;
    return common == (is_inner ? 2 : 1);
  }

  /// Whether no face that stays would turn over.
  [[nodiscard]] bool keeps_sides(Index h) {
    const Index v = start(h), w = end(h);
    const Vec3 joint = joint_middle(v, w);
    bool keeps = true;
    const auto look = [&](Index from, Index other) {
      for_each_out(from, [&](Index g) {
        const Vec3 &p = middle_[end(g)], &q = middle_[start(previous_halfedge(g))];
        if (end(g) == other || start(previous_halfedge(g)) == other) return;
        const Vec3 before = normal_of(middle_[from], p, q), after = normal_of(joint, p, q);
        keeps = keeps && before.dot(after) > 0;
      });
    };
    look(v, w);
    look(w, v);
    return keeps;
  }

  static Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    return {ab.y() * ac.z() - ab.z() * ac.y(), ab.z() * ac.x() - ab.x() * ac.z(),
            ab.x() * ac.y() - ab.y() * ac.x()};
  }

  /// The start of h becomes its end; the faces on both sides of it go.
  void contract(Index h) {
    const Index v = start(h), w = end(h), other = twin_[h];
    middle_[w] = joint_middle(v, w);
    area_[w] += area_[v];
    spokes_.clear();
    for_each_out(v, [&](Index g) { spokes_.push_back(g); });
    for (const Index g : spokes_) faces_[face_of(g)][g % 3] = w;
    into_[v] = w;
    out_[v] = kDead;
    close(h);
    if (other != kNoTwin) close(other);
  }

  /// Takes the face of h out: its two other sides become one edge.
  void close(Index h) {
    const Index n = twin_[next_halfedge(h)], p = twin_[previous_halfedge(h)];
    const Index w = end(h), apex = start(previous_halfedge(h));
    if (n != kNoTwin) twin_[n] = p;
    if (p != kNoTwin) twin_[p] = n;
    if (n != kNoTwin && p != kNoTwin && kept_[n] != kept_[p]) kept_[n] = kept_[p] = 1;
    out_[w] = p != kNoTwin ? p : next_halfedge(n);
    out_[apex] = n != kNoTwin ? n : next_halfedge(p);
    faces_[face_of(h)] = {kDead, kDead, kDead};
    --face_count_;
  }

  std::vector<Triangle> faces_;  ///< over clusters; those that are gone are kDead
  std::vector<Index> twin_;
  std::vector<char> kept_;  ///< one a half-edge, 1: its clusters stay apart
  Index face_count_;
  std::vector<Index> out_;   ///< a half-edge that starts in each vertex; kDead: joined to another
  std::vector<Index> into_;  ///< the vertex that a vertex was joined to; itself while it lives
  std::vector<double> area_;
  std::vector<Vec3> middle_;
  std::vector<Index> stamp_;  ///< the look at which a vertex was last seen
  std::vector<Index> spokes_;
  Index now_ = 0;
  double total_ = 0;
};

}  // namespace

std::vector<char> core_faces(const Coarse& coarse, std::size_t faces) {
  std::vector<char> is_core(faces, 0);
  for (const Index t : coarse.face) is_core[t] = 1;
  return is_core;
}

std::vector<double> coarse_avoid(const Coarse& coarse, const TriMesh& mesh,
                                 const Halfedges& halfedges) {
  if (coarse.avoid.empty()) return {};
  std::vector<double> mean(coarse.mesh.positions.size(), 0), count(mean.size(), 0);
  for (Index h = 0; h < static_cast<Index>(coarse.avoid.size()); ++h) {
    const Index c = coarse.cluster[start_of(mesh.faces, h)];
    mean[c] += charts::is_kept(coarse.avoid, h) ? 0 : coarse.avoid[h];
    ++count[c];
  }
  for (std::size_t c = 0; c < mean.size(); ++c) mean[c] /= count[c];
  const std::vector<char> is_core = core_faces(coarse, mesh.faces.size());
  std::vector<double> avoid;
  for (Index h = 0; h < 3 * coarse.mesh.face_count(); ++h) {
    avoid.push_back((mean[start_of(coarse.mesh.faces, h)] + mean[end_of(coarse.mesh.faces, h)]) /
                    2);
    if (coarse.halfedges.twin[h] == kNoTwin) continue;
    for_each_of_strip(coarse, mesh, halfedges, is_core, h, [&](Index g) {
      if (charts::is_kept(coarse.avoid, g)) avoid[h] = charts::kKept;
    });
  }
  return avoid;
}

Coarse coarsen(const TriMesh& mesh, const Halfedges& halfedges, Index faces,
               const std::stop_token& stop, std::span<const double> avoid) {
  Contraction contraction(mesh, halfedges, avoid, stop);
  contraction.run(faces, stop);
  throw_if_cancelled(stop);
  return contraction.result();
}

}  // namespace unwrapd::segment
