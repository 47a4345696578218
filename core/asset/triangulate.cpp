// Ear clipping in the plane of the polygon's Newell normal. Polygons of scans and CAD are short;
// a very long one is cut as a fan, because ears cost its square.
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/asset/as_size.hpp"
#include "core/asset/obj.hpp"
#include "core/asset/pace.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kMaxEarCorners = 512;

Vec3 newell_normal(std::span<const Vec3> polygon) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    normal += (polygon[i] - polygon[0]).cross(polygon[(i + 1) % polygon.size()] - polygon[0]);
  return normal;
}

/// Twice the signed area of abc.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The polygon's corners in the plane, turning left around it. A polygon without area lies on a
/// point, and has no ears.
std::vector<Vec2> flattened(std::span<const Vec3> polygon) {
  const Vec3 normal = newell_normal(polygon).stableNormalized();
  if (normal.isZero(0)) return std::vector<Vec2>(polygon.size(), Vec2::Zero());
  const Vec3 right = normal.unitOrthogonal(), up = normal.cross(right);
  std::vector<Vec2> points;
  points.reserve(polygon.size());
  for (const Vec3& p : polygon)
    points.emplace_back((p - polygon[0]).dot(right), (p - polygon[0]).dot(up));
  return points;
}

/// Cuts ears off: corners that turn left and whose triangle no corner lies in that turns right.
/// (Meisters, Polygons have ears, 1975.) A cut changes what its two neighbours are and nothing
/// else, so that all cuts together cost the polygon's corners times those that turn right.
class EarClipper {
 public:
  EarClipper(std::span<const Vec3> polygon, Pace& pace)
      : points_(flattened(polygon)),
        pace_(pace),
        ring_(polygon.size()),
        turns_left_(polygon.size(), 0),
        is_ear_(polygon.size(), 0) {
    std::iota(ring_.begin(), ring_.end(), 0);
    for (std::size_t i = 0; i < ring_.size(); ++i) look_at_turn(i);
    for (std::size_t i = 0; i < ring_.size(); ++i) look_at_ear(i);
  }

  void clip(std::vector<std::array<Index, 3>>& triangles) {
    while (ring_.size() > 3) {
      const std::size_t ear = find_ear();
      triangles.push_back(corner_triangle(ear));
      ring_.erase(ring_.begin() + std::ptrdiff_t(ear));
      const std::size_t n = ring_.size(), after = ear % n, before = (ear + n - 1) % n;
      for (const std::size_t i : {before, after}) look_at_turn(i);
      for (const std::size_t i : {before, after}) look_at_ear(i);
    }
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
  }

 private:
  [[nodiscard]] std::array<Index, 3> corner_triangle(std::size_t i) const {
    const std::size_t n = ring_.size();
    return {ring_[(i + n - 1) % n], ring_[i], ring_[(i + 1) % n]};
  }

  [[nodiscard]] const Vec2& at(Index corner) const { return points_[as_size(corner)]; }

  void look_at_turn(std::size_t i) {
    const auto [a, b, c] = corner_triangle(i);
    turns_left_[as_size(b)] = turn(at(a), at(b), at(c)) > 0 ? 1 : 0;
  }

  void look_at_ear(std::size_t i) {
    const std::array<Index, 3> t = corner_triangle(i);
    is_ear_[as_size(t[1])] = turns_left_[as_size(t[1])] != 0 && !contains_a_corner(t) ? 1 : 0;
  }

  /// Where a corner lies in the triangle, so does one that turns right.
  [[nodiscard]] bool contains_a_corner(const std::array<Index, 3>& t) const {
    pace_.add(ring_.size() / 4);
    const Vec2 &a = at(t[0]), &b = at(t[1]), &c = at(t[2]);
    return std::any_of(ring_.begin(), ring_.end(), [&](Index other) {
      if (turns_left_[as_size(other)] != 0 || other == t[0] || other == t[2]) return false;
      const Vec2& p = at(other);
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
    });
  }

  /// The second corner first, so that a convex polygon becomes a fan around its first. A polygon
  /// that crosses itself may have no ear: any corner will do.
  [[nodiscard]] std::size_t find_ear() const {
    const std::size_t n = ring_.size();
    for (std::size_t k = 1; k <= n; ++k)
      if (is_ear_[as_size(ring_[k % n])] != 0) return k % n;
    return 1;
  }

  std::vector<Vec2> points_;  ///< of all corners
  Pace& pace_;
  std::vector<Index> ring_;  ///< the corners that are left
  std::vector<char> turns_left_, is_ear_;
};

}  // namespace

void triangulate(std::span<const Vec3> polygon, std::vector<std::array<Index, 3>>& triangles,
                 Pace& pace) {
  assert(polygon.size() >= 3);
  pace.add(polygon.size());
  if (polygon.size() == 3) {
    triangles.push_back({0, 1, 2});
  } else if (polygon.size() <= kMaxEarCorners) {
    EarClipper(polygon, pace).clip(triangles);
  } else {
    for (Index i = 1; i + 1 < static_cast<Index>(polygon.size()); ++i)
      triangles.push_back({0, i, i + 1});
  }
}

}  // namespace unwrapd::asset
