// Hierarchical face clustering: Garland, Willmott, Heckbert, "Hierarchical Face Clustering on
// Polygonal Surfaces", I3D 2001, with the L2,1 metric of Cohen-Steiner, Alliez, Desbrun 2004.
//
// Every face begins as a cluster; the two neighbours whose union adds least to the variation of
// normals, for the border that it removes and the roundness that it leaves, become one, until no
// union is flat enough. Rejected: Lloyd iterations on proxies (Cohen-Steiner et al.): the number of
// patches must be known, and patches fall apart.
#include "core/segment/cluster.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <queue>
#include <tuple>

#include "core/base/cancel.hpp"
#include "core/segment/labels.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kBaseCost = 2e-3;  // of an area, so that flat neighbours merge small ones first
constexpr int kStepsBetweenLooks = 256;

struct Cluster {
  Vec3 normal_sum = Vec3::Zero();  ///< area-weighted
  double area = 0;
  double perimeter = 0;
  int version = 0;                  ///< of what the queue knows; -1 once it is part of another
  std::map<Index, double> borders;  ///< neighbour -> length of the common border
};

class Clustering {
 public:
  Clustering(const SegmentationMesh& surface, std::span<const Vec3> normals, double flatness)
      : flatness_(flatness), clusters_(surface.mesh.faces.size()), into_(clusters_.size()) {
    for (Index t = 0; t < surface.face_count(); ++t) add_face(surface, t, normals[t]);
    for (Index t = 0; t < surface.face_count(); ++t)
      for (const auto& [other, length] : clusters_[t].borders)
        if (t < other) push(t, other);
  }

  void run(const std::stop_token& stop) {
    for (int step = 0; !queue_.empty(); ++step) {
      if (step % kStepsBetweenLooks == 0) throw_if_cancelled(stop);
      const auto [cost, a, b, version_a, version_b] = queue_.top();
      queue_.pop();
      if (clusters_[a].version == version_a && clusters_[b].version == version_b) join(a, b);
    }
  }

  [[nodiscard]] std::vector<Index> labels() const {
    std::vector<Index> label(into_.size());
    for (std::size_t t = 0; t < label.size(); ++t) {
      Index root = static_cast<Index>(t);
      while (into_[root] != root) root = into_[root];
      label[t] = root;
    }
    return label;
  }

 private:
  using Candidate = std::tuple<double, Index, Index, int, int>;

  void add_face(const SegmentationMesh& surface, Index t, const Vec3& normal) {
    Cluster& own = clusters_[t];
    into_[t] = t;
    own.area = surface.area(t);
    own.normal_sum = own.area * normal;
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      own.perimeter += surface.seam_cost[h];
      const Index twin = surface.halfedges.twin[h];
      if (twin != kNoTwin && face_of(twin) != t) own.borders[face_of(twin)] += surface.seam_cost[h];
    }
  }

  void push(Index a, Index b) {
    const Cluster &x = clusters_[a], &y = clusters_[b];
    const double length = x.borders.at(b), area = x.area + y.area;
    const double together = (x.normal_sum + y.normal_sum).norm();
    if (area - together > flatness_ * area) return;
    const double variation = x.normal_sum.norm() + y.normal_sum.norm() - together;
    const double perimeter = x.perimeter + y.perimeter - 2 * length;
    const double roundness = perimeter * perimeter / (4 * std::numbers::pi * area);
    const double cost = (variation + kBaseCost * std::min(x.area, y.area)) *
                        std::sqrt(std::max(roundness, 1.0)) / length;
    queue_.emplace(rounded(cost), a, b, x.version, y.version);
  }

  /// b becomes part of a, or a of b where b has more neighbours.
  void join(Index a, Index b) {
    if (clusters_[a].borders.size() < clusters_[b].borders.size()) std::swap(a, b);
    Cluster &x = clusters_[a], &y = clusters_[b];
    x.normal_sum += y.normal_sum;
    x.area += y.area;
    x.perimeter += y.perimeter - 2 * x.borders.at(b);
    ++x.version;
    y.version = -1;
    into_[b] = a;
    x.borders.erase(b);
    for (const auto& [other, length] : y.borders) {
      if (other == a) continue;
      x.borders[other] += length;
      clusters_[other].borders.erase(b);
      clusters_[other].borders[a] += length;
    }
    y.borders.clear();
    for (const auto& [other, length] : x.borders) push(a, other);
  }

  double flatness_;
  std::vector<Cluster> clusters_;
  std::vector<Index> into_;  ///< the cluster that a cluster became part of; itself while it lives
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

std::vector<Index> cluster_faces(const SegmentationMesh& surface, std::span<const Vec3> normals,
                                 double flatness, const std::stop_token& stop) {
  Clustering clustering(surface, normals, flatness);
  clustering.run(stop);
  std::vector<Index> label = clustering.labels();
  renumber(label);
  return label;
}

}  // namespace unwrapd::segment
