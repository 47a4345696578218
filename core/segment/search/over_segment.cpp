// Hierarchical face clustering: Garland, Willmott, Heckbert, "Hierarchical Face Clustering on
// Polygonal Surfaces", I3D 2001, with the L2,1 metric of Cohen-Steiner, Alliez, Desbrun 2004.
//
// Every face begins as a cluster. The two neighbours become one whose union adds least to the
// variation of normals, compared with the border that it removes and the roundness that it leaves;
// this ends when no union is flat enough. Rejected: Lloyd iterations on proxies (Cohen-Steiner et
// al.): the number of regions must be known, and regions fall apart.
//
// The flatness is tightened until the regions use only their part of the distortion. A region
// without a sound map (a tube, a fold) is clustered again, ever more tightly. This ends because a
// single triangle always has a sound map. Flat regions at a sharp edge stay apart however small one
// of them is, since only merging finds along which edges a box unfolds best (ADR 0083).
#include "core/segment/search/over_segment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/mesh/disjoint_sets.hpp"
#include "core/segment/base/labels.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr double kFlatness = 0.06;  // mean 1 - cosine within a region; half for each next round
constexpr int kFlatnessRounds = 6;
constexpr double kShareOfStart = 0.3;  // of the budget, that the first regions may use
constexpr double kRefinement = 0.3;    // of flatness, each time a region has no sound map
constexpr int kRefinements = 4;        // then the region falls into its triangles
constexpr int kSmoothingPasses = 3;
constexpr double kSmoothCosine = 0.9;  // smoothing of borders does not reach around sharper edges
constexpr double kShareOfWork = 0.1, kFacesOfStart = 6;  // of the work; for each face
constexpr std::size_t kRegionsAtOnce = 16;               // then progress is told
constexpr double kBaseCost = 2e-3;  // of an area, so that flat neighbours merge small ones first
constexpr double kPlane = 1 - 1e-6, kSharpCosine = 0.5;  // of flat regions that stay apart
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
    if (area - together > flatness_ * area || meet_sharply(x, y)) return;
    const double variation = x.normal_sum.norm() + y.normal_sum.norm() - together;
    const double perimeter = x.perimeter + y.perimeter - 2 * length;
    const double roundness = perimeter * perimeter / (4 * std::numbers::pi * area);
    const double cost = (variation + kBaseCost * std::min(x.area, y.area)) *
                        std::sqrt(std::max(roundness, 1.0)) / length;
    queue_.emplace(rounded(cost), a, b, x.version, y.version);
  }

  /// Whether both are flat, and the angle between them is sharp.
  static bool meet_sharply(const Cluster& x, const Cluster& y) {
    const double a = x.normal_sum.norm(), b = y.normal_sum.norm();
    return a >= kPlane * x.area && b >= kPlane * y.area &&
           x.normal_sum.dot(y.normal_sum) < kSharpCosine * a * b;
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

/// One label a face, ascending by first face; the faces of a label are connected. Within a label
/// the mean of (1 - cosine of the angle to its mean normal) stays below flatness, in (0, 2).
std::vector<Index> cluster_faces(const SegmentationMesh& surface, double flatness,
                                 const std::stop_token& stop) {
  Clustering clustering(surface, surface.normal, flatness);
  clustering.run(stop);
  std::vector<Index> label = clustering.labels();
  renumber(label);
  return label;
}

/// Faces at kept edges leave their labels and are joined across these edges alone: unions that must
/// be are then no larger than need be, and a tube of them can still be cut beside the edges.
void separate_kept(const SegmentationMesh& surface, std::vector<Index>& label) {
  const Index faces = surface.face_count();
  DisjointSets joined(label.size());
  for (Index h = 0; h < static_cast<Index>(surface.kept.size()); ++h)
    if (surface.kept[h] != 0) joined.join(face_of(h), face_of(surface.halfedges.twin[h]));
  for (Index h = 0; h < static_cast<Index>(surface.kept.size()); ++h)
    if (surface.kept[h] != 0) label[face_of(h)] = faces + joined.root(face_of(h));
  separate_labels(surface.halfedges, label);
}

/// The region of each label with a map, which starts from its projection.
std::vector<MappedRegion> map_regions(const MergeContext& context, std::vector<Index>& label,
                                      Executor& executor) {
  const SegmentationMesh& surface = context.surface;
  std::vector<std::vector<Index>> faces = faces_by_label(label, renumber(label));
  std::vector<MappedRegion> regions(faces.size());
  const auto map = [&](std::size_t k) {
    MappedRegion& region = regions[k];
    region.faces = std::move(faces[k]);
    region.uv = projected(surface, region.faces);
    const TestRules rules{.most_excess = std::numeric_limits<double>::infinity(),
                          .stop = context.stop};
    const TestResult result = test_parameterization(surface, {}, rules, region);
    region.excess = result.excess;
    region.is_sound = result.verdict == Verdict::sound;
    for (const Index t : region.faces) region.area += surface.area(t);
  };
  for (std::size_t first = 0; first < regions.size(); first += kRegionsAtOnce) {
    const std::size_t count = std::min(kRegionsAtOnce, regions.size() - first);
    executor.for_each_block(static_cast<int>(count),
                            [&](int block) { map(first + static_cast<std::size_t>(block)); });
    throw_if_cancelled(context.stop);
    std::size_t mapped = 0;
    for (std::size_t k = first; k < first + count; ++k) mapped += regions[k].faces.size();
    context.progress->add(mapped);
  }
  return regions;
}

/// Splits regions without a sound map into smaller ones, by the finer labels.
void split_unsound(const SegmentationMesh& surface, std::span<const MappedRegion> regions,
                   std::span<const Index> finer, std::vector<Index>& label) {
  const auto face_count = static_cast<Index>(label.size());
  for (const MappedRegion& region : regions) {
    if (region.is_sound) continue;
    for (const Index t : region.faces) label[t] = face_count + finer[t];
  }
  separate_labels(surface.halfedges, label);
}

std::vector<MappedRegion> sound_regions(const MergeContext& context, double flatness,
                                        std::vector<Index> label, Executor& executor) {
  const SegmentationMesh& surface = context.surface;
  std::vector<MappedRegion> regions = map_regions(context, label, executor);
  const auto is_sound = [](const MappedRegion& region) { return region.is_sound; };
  for (int k = 0; k <= kRefinements && !std::ranges::all_of(regions, is_sound); ++k) {
    flatness *= kRefinement;
    std::vector<Index> finer(label.size());
    std::iota(finer.begin(), finer.end(), 0);
    if (k < kRefinements) finer = cluster_faces(surface, flatness, context.stop);
    split_unsound(surface, regions, finer, label);
    regions = map_regions(context, label, executor);
  }
  return regions;
}

}  // namespace

std::vector<MappedRegion> over_segment(const MergeContext& context, double excess,
                                       Executor& executor) {
  const SegmentationMesh& surface = context.surface;
  context.progress->begin(kShareOfWork, kFacesOfStart * surface.face_count());
  const double allowed = kShareOfStart * excess;
  double flatness = kFlatness;
  for (int round = 1;; ++round, flatness /= 2) {
    std::vector<Index> label = cluster_faces(surface, flatness, context.stop);
    smooth_labels(surface, kSmoothingPasses, kSmoothCosine, label);
    if (!surface.kept.empty()) separate_kept(surface, label);
    std::vector<MappedRegion> regions = sound_regions(context, flatness, label, executor);
    if (round == kFlatnessRounds || total_excess(regions).worst() <= allowed) return regions;
  }
}

}  // namespace unwrapd::segment::search
