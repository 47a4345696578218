// Ear clipping in the plane of the polygon's Newell normal. Polygons of scans and CAD are short;
// a very long one is cut as a fan, because ears cost its square.
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/asset/obj.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kMaxEarCorners = 512;

Vec3 newell_normal(std::span<const Vec3> polygon) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    normal += (polygon[i] - polygon[0]).cross(polygon[(i + 1) % polygon.size()] - polygon[0]);
  return normal;
}

/// Twice the signed area of abc as seen along the normal.
double turn(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  return (b - a).cross(c - a).dot(normal);
}

class EarClipper {
 public:
  explicit EarClipper(std::span<const Vec3> polygon)
      : polygon_(polygon), normal_(newell_normal(polygon)), ring_(polygon.size()) {
    std::iota(ring_.begin(), ring_.end(), 0);
  }

  void clip(std::vector<std::array<Index, 3>>& triangles) {
    while (ring_.size() > 3) {
      const std::size_t ear = find_ear();
      triangles.push_back(corner_triangle(ear));
      ring_.erase(ring_.begin() + std::ptrdiff_t(ear));
    }
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
  }

 private:
  [[nodiscard]] std::array<Index, 3> corner_triangle(std::size_t i) const {
    const std::size_t n = ring_.size();
    return {ring_[(i + n - 1) % n], ring_[i], ring_[(i + 1) % n]};
  }

  [[nodiscard]] const Vec3& at(Index corner) const {
    return polygon_[static_cast<std::size_t>(corner)];
  }

  [[nodiscard]] bool contains_a_corner(const std::array<Index, 3>& t) const {
    return std::any_of(ring_.begin(), ring_.end(), [&](Index other) {
      if (other == t[0] || other == t[1] || other == t[2]) return false;
      const Vec3& p = at(other);
      return turn(at(t[0]), at(t[1]), p, normal_) >= 0 &&
             turn(at(t[1]), at(t[2]), p, normal_) >= 0 && turn(at(t[2]), at(t[0]), p, normal_) >= 0;
    });
  }

  /// The second corner first, so that a convex polygon becomes a fan around its first. A polygon
  /// that crosses itself may have no ear: any corner will do.
  [[nodiscard]] std::size_t find_ear() const {
    for (std::size_t k = 1; k <= ring_.size(); ++k) {
      const std::array<Index, 3> t = corner_triangle(k % ring_.size());
      if (turn(at(t[0]), at(t[1]), at(t[2]), normal_) > 0 && !contains_a_corner(t))
        return k % ring_.size();
    }
    return 1;
  }

  std::span<const Vec3> polygon_;
  Vec3 normal_;
  std::vector<Index> ring_;
};

}  // namespace

void triangulate(std::span<const Vec3> polygon, std::vector<std::array<Index, 3>>& triangles) {
  assert(polygon.size() >= 3);
  if (polygon.size() == 3) {
    triangles.push_back({0, 1, 2});
  } else if (polygon.size() <= kMaxEarCorners) {
    EarClipper(polygon).clip(triangles);
  } else {
    for (Index i = 1; i + 1 < static_cast<Index>(polygon.size()); ++i)
      triangles.push_back({0, i, i + 1});
  }
}

}  // namespace unwrapd::asset
