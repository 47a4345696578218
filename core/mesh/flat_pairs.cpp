#include "core/mesh/flat_pairs.hpp"

#include <Eigen/Geometry>

#include <algorithm>

#include "core/mesh/counting_sort.hpp"

namespace unwrapd {
namespace {

constexpr double kFlat = 0.866;            // cosine of 30 degrees
constexpr double kLead = 0.1;              // of the best cosine over the next
constexpr std::ptrdiff_t kMostFaces = 64;  // at an edge: each is compared with each

Vec3 normal_of(std::span<const Vec3> positions, const Triangle& face) {
  const auto& [a, b, c] = face;
  const Vec3 ab = (positions[b] - positions[a]).stableNormalized();
  const Vec3 ac = (positions[c] - positions[a]).stableNormalized();
  return ab.cross(ac).stableNormalized();
}

/// The faces at one edge.
class Fan {
 public:
  Fan(std::span<const Vec3> positions, std::span<const Triangle> faces,
      std::span<const EdgeSide> sides)
      : faces_(faces), sides_(sides) {
    for (const EdgeSide& side : sides)
      normals_.push_back(normal_of(positions, faces[face_of(side.halfedge)]));
  }

  void append_pairs(std::vector<HalfedgePair>& pairs) const {
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const std::size_t other = flattest(k);
      if (other == k || flattest(other) != k) continue;
      const Index g = sides_[k].halfedge, h = sides_[other].halfedge;
      if (g < h) pairs.push_back({g, h});
    }
  }

 private:
  /// The side across which the surface goes on from side k without a crease; k if there is none.
  [[nodiscard]] std::size_t flattest(std::size_t k) const {
    std::size_t best = k;
    double most = -1, next = -1;
    for (std::size_t j = 0; j < sides_.size(); ++j) {
      if (start_of(faces_, sides_[j].halfedge) == start_of(faces_, sides_[k].halfedge)) continue;
      const double cosine = normals_[k].dot(normals_[j]);
      next = std::max(next, std::min(cosine, most));
      if (cosine > most) most = cosine, best = j;
    }
    return most > kFlat && most - next > kLead ? best : k;
  }

  std::span<const Triangle> faces_;
  std::span<const EdgeSide> sides_;
  std::vector<Vec3> normals_;
};

}  // namespace

std::vector<HalfedgePair> flat_pairs(std::span<const Vec3> positions,
                                     std::span<const Triangle> welded,
                                     std::span<const FaceState> areas,
                                     const std::stop_token& stop) {
  auto sides = edge_sides(
      welded, [&](Index h) { return areas[face_of(h)] == FaceState::sound; }, stop);
  sort_by_edge(sides, static_cast<Index>(positions.size()), stop);
  std::vector<HalfedgePair> pairs;
  for_each_run(
      sides, on_one_edge,
      [&](const EdgeSide* first, const EdgeSide* last) {
        if (last - first > 2 && last - first <= kMostFaces)
          Fan(positions, welded, {first, last}).append_pairs(pairs);
      },
      stop);
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace unwrapd
