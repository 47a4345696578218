// Distances run over faces, from middle to middle in the region's map, so that a slit or a hollow
// is gone around: a ring that was cut open comes apart where it is farthest from its ends.
#include "core/segment/search/bisect.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "core/segment/base/labels.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr double kLeastPart = 0.08;  // of the region's area, before a neck
constexpr int kPasses = 10;          // over all faces

class Bisection {
 public:
  Bisection(const SegmentationMesh& surface, const Partition& partition, const Region& region)
      : surface_(surface),
        open_(partition.open),
        region_(region),
        number_(surface.mesh.faces.size(), -1) {
    for (std::size_t k = 0; k < region.faces.size(); ++k)
      number_[region.faces[k]] = static_cast<Index>(k);
  }

  /// Of each face of the region: 0 or 1.
  [[nodiscard]] std::vector<char> find(std::size_t way) const {
    return smoothed(way == 0 ? halves() : cut_at_neck(distances_from_tip(way)));
  }

 private:
  static std::size_t farthest(const std::vector<double>& distance) {
    return static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
  }

  [[nodiscard]] std::vector<char> halves() const {
    const std::vector<double> from_a = distances_from_tip(1);
    const std::vector<double> from_b = distances(farthest(from_a));
    std::vector<char> half(from_a.size());
    for (std::size_t k = 0; k < half.size(); ++k) half[k] = from_b[k] < from_a[k] ? 1 : 0;
    return half;
  }

  /// The first tip is farthest from face 0, each other one from the tips before it.
  [[nodiscard]] std::vector<double> distances_from_tip(std::size_t number) const {
    std::vector<double> from_tip = distances(farthest(distances(0))), from_nearest = from_tip;
    for (std::size_t n = 1; n < number; ++n) {
      from_tip = distances(farthest(from_nearest));
      for (std::size_t k = 0; k < from_tip.size(); ++k)
        from_nearest[k] = std::min(from_nearest[k], from_tip[k]);
    }
    return from_tip;
  }

  /// Of all cuts at one distance: the cheapest for the area of the smaller part (Cheeger's ratio).
  [[nodiscard]] std::vector<char> cut_at_neck(const std::vector<double>& from_tip) const {
    std::vector<std::size_t> order(from_tip.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::less(), [&](std::size_t k) { return from_tip[k]; });
    double all = 0, near = 0, width = 0, least = std::numeric_limits<double>::infinity();
    for (const Index t : region_.faces) all += surface_.area(t);
    std::vector<char> is_near(order.size(), 0);
    std::size_t cut = 0;
    for (std::size_t n = 0; n < order.size(); ++n) {
      width += change_of_width(order[n], is_near);
      is_near[order[n]] = 1;
      near += surface_.area(region_.faces[order[n]]);
      const double smaller = std::min(near, all - near);
      const bool is_tie = n + 1 < order.size() && from_tip[order[n + 1]] == from_tip[order[n]];
      if (is_tie || smaller < kLeastPart * all || rounded(width / smaller) >= least) continue;
      least = rounded(width / smaller);
      cut = n + 1;
    }
    for (std::size_t n = cut; n < order.size(); ++n) is_near[order[n]] = 0;
    return is_near;
  }

  /// Faces go over to the other part where that makes the cut cheaper, so that its ends lie well,
  /// too: those stay where it is drawn straight.
  [[nodiscard]] std::vector<char> smoothed(std::vector<char> part) const {
    bool is_changed = true;
    for (int pass = 0; pass < kPasses && is_changed; ++pass) {
      is_changed = false;
      for (std::size_t k = 0; k < part.size(); ++k) {
        std::array<double, 2> cost{};  // of the sides to each part
        for (Index h = 3 * region_.faces[k]; h < 3 * region_.faces[k] + 3; ++h)
          if (const std::optional<std::size_t> other = across(h))
            cost[static_cast<std::size_t>(part[*other])] += surface_.seam_cost[h];
        const auto own = static_cast<std::size_t>(part[k]);
        if (rounded(cost[own]) >= rounded(cost[1 - own])) continue;
        part[k] = static_cast<char>(1 - own);
        is_changed = true;
      }
    }
    return part;
  }

  /// Of the cut around the near faces, when face k is added to them.
  [[nodiscard]] double change_of_width(std::size_t k, const std::vector<char>& is_near) const {
    double change = 0;
    for (Index h = 3 * region_.faces[k]; h < 3 * region_.faces[k] + 3; ++h)
      if (const std::optional<std::size_t> other = across(h))
        change += is_near[*other] != 0 ? -surface_.seam_cost[h] : surface_.seam_cost[h];
    return change;
  }

  /// The face of the region that is glued there.
  [[nodiscard]] std::optional<std::size_t> across(Index h) const {
    const Index twin = surface_.halfedges.twin[h];
    if (twin == kNoTwin || open_[h] != 0 || number_[face_of(twin)] < 0) return std::nullopt;
    return static_cast<std::size_t>(number_[face_of(twin)]);
  }

  [[nodiscard]] Vec2 middle(std::size_t k) const {
    const CornerUv& uv = region_.uv[k];
    return (uv[0] + uv[1] + uv[2]) / 3;
  }

  /// Dijkstra's, from face `first` of the region.
  [[nodiscard]] std::vector<double> distances(std::size_t first) const {
    using Reached = std::pair<double, std::size_t>;
    std::vector<double> distance(region_.faces.size(), std::numeric_limits<double>::infinity());
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
    distance[first] = 0;
    front.push({0, first});
    while (!front.empty()) {
      const auto [own, k] = front.top();
      front.pop();
      if (own > distance[k]) continue;
      for (Index h = 3 * region_.faces[k]; h < 3 * region_.faces[k] + 3; ++h) {
        const std::optional<std::size_t> other = across(h);
        if (!other) continue;
        const double reached = own + (middle(k) - middle(*other)).norm();
        if (!(reached < distance[*other])) continue;
        distance[*other] = reached;
        front.push({reached, *other});
      }
    }
    for (double& d : distance) d = rounded(d);
    return distance;
  }

  const SegmentationMesh& surface_;
  const std::vector<char>& open_;
  const Region& region_;
  std::vector<Index> number_;  ///< of a face in the region; -1: not in it
};

}  // namespace

std::optional<Partition> bisect(const MergeContext& context, const MergeSettings& settings,
                                const Partition& partition, std::size_t k, std::size_t way) {
  const SegmentationMesh& surface = context.surface;
  const MappedRegion& whole = partition.regions[k];
  const double most = std::max(settings.cap, whole.mean_excess());
  const std::vector<char> half = Bisection(surface, partition, whole).find(way);
  std::array<MappedRegion, 2> parts;
  for (std::size_t f = 0; f < half.size(); ++f) {
    MappedRegion& part = parts[static_cast<std::size_t>(half[f])];
    part.faces.push_back(whole.faces[f]);
    part.uv.push_back(whole.uv[f]);
    part.area += surface.area(whole.faces[f]);
  }
  for (MappedRegion& part : parts) {
    if (part.faces.empty()) return std::nullopt;
    const TestRules trial{
        .most_excess = most * part.area, .stop = context.stop, .memory = context.failures};
    const TestResult result = test_parameterization(surface, partition.open, trial, part);
    if (context.progress != nullptr) context.progress->add(part.faces.size());
    if (result.verdict != Verdict::sound) return std::nullopt;
    part.excess = result.excess;
    part.is_sound = true;
  }
  Partition cut = partition;
  cut.regions[k] = std::move(parts[0]);
  cut.regions.push_back(std::move(parts[1]));
  return cut;
}

}  // namespace unwrapd::segment::search
