// Distances run over faces, from middle to middle in the region's map, so that a slit or a hollow
// is gone around: a ring that was cut open comes apart where it is farthest from its ends.
#include "core/segment/search/bisect.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace unwrapd::segment::search {
namespace {

class Halving {
 public:
  Halving(const SegmentationMesh& surface, const Partition& partition, const Region& region)
      : surface_(surface),
        open_(partition.open),
        region_(region),
        number_(surface.mesh.faces.size(), -1) {
    for (std::size_t k = 0; k < region.faces.size(); ++k)
      number_[region.faces[k]] = static_cast<Index>(k);
  }

  /// Of each face of the region: 0 or 1.
  [[nodiscard]] std::vector<char> find() const {
    const std::size_t a = farthest(distances(0));
    const std::vector<double> from_a = distances(a);
    const std::vector<double> from_b = distances(farthest(from_a));
    std::vector<char> half(from_a.size());
    for (std::size_t k = 0; k < half.size(); ++k) half[k] = from_b[k] < from_a[k] ? 1 : 0;
    return half;
  }

 private:
  static std::size_t farthest(const std::vector<double>& distance) {
    return static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
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
        const Index twin = surface_.halfedges.twin[h];
        if (twin == kNoTwin || open_[h] != 0 || number_[face_of(twin)] < 0) continue;
        const auto other = static_cast<std::size_t>(number_[face_of(twin)]);
        const double way = own + (middle(k) - middle(other)).norm();
        if (!(way < distance[other])) continue;
        distance[other] = way;
        front.push({way, other});
      }
    }
    return distance;
  }

  const SegmentationMesh& surface_;
  const std::vector<char>& open_;
  const Region& region_;
  std::vector<Index> number_;  ///< of a face in the region; -1: not in it
};

}  // namespace

std::optional<Partition> bisect(const MergeContext& context, const Partition& partition,
                                std::size_t k) {
  const SegmentationMesh& surface = context.surface;
  const Region& whole = partition.regions[k];
  const std::vector<char> half = Halving(surface, partition, whole).find();
  std::array<MappedRegion, 2> parts;
  for (std::size_t f = 0; f < half.size(); ++f) {
    MappedRegion& part = parts[static_cast<std::size_t>(half[f])];
    part.faces.push_back(whole.faces[f]);
    part.uv.push_back(whole.uv[f]);
    part.area += surface.area(whole.faces[f]);
  }
  for (MappedRegion& part : parts) {
    if (part.faces.empty()) return std::nullopt;
    const TestRules trial{.most_excess = std::numeric_limits<double>::infinity(),
                          .stop = context.stop,
                          .memory = context.failures};
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
