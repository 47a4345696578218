// The bounding rectangle of least area has a side on the convex hull's (Freeman and Shapira 1975),
// so each side of the hull is tried, with the three opposite contacts walked along ("rotating
// calipers", Toussaint 1983): n log n for the hull, then linear. Andrew's monotone chain.
#include "core/pack/box.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/charts/outline.hpp"
#include "core/mesh/cross.hpp"

namespace unwrapd::pack {
namespace {

constexpr int kSquareAngles = 180;        // in a quarter turn
constexpr double kSquareGain = 1 - 1e-6;  // least gain for which an island is rotated
constexpr std::size_t kStraightTries = 16;
constexpr double kMostlyStraight = 0.5;  // of the length of all sides
constexpr double kStraight = 0.01;       // the product of sine and cosine, at most

/// Appends one chain of the hull to `hull`. Entries before `base` stay.
template <class Iterator>
void add_chain(Iterator first, Iterator last, std::size_t base, UvMap& hull) {
  for (Iterator p = first; p != last; ++p) {
    while (hull.size() >= base + 2 &&
           cross(hull.back() - hull[hull.size() - 2], *p - hull.back()) <= 0)
      hull.pop_back();
    hull.push_back(*p);
  }
  hull.pop_back();  // the next chain begins with it
}

/// The box of the points after a rotation that takes `direction` (of unit length) to the right.
Box box_along(std::span<const Vec2> points, const Vec2& direction) {
  Box box{direction.x(), -direction.y(), Vec2::Zero(), Vec2::Zero()};
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (const Vec2& p : points) {
    const Vec2 q(direction.dot(p), cross(direction, p));
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  box.low = low;
  box.size = high - low;
  return box;
}

/// The direction of the hull's side on which the least rectangle stands.
Vec2 best_direction(const UvMap& hull) {
  const std::size_t n = hull.size();
  const auto at = [&](std::size_t k) -> const Vec2& { return hull[k % n]; };
  Vec2 best = Vec2::UnitX();
  double least = -1;
  std::size_t right = 0, top = 0, left = 0;
  const auto climb = [&](std::size_t& k, const Vec2& way) {
    for (std::size_t steps = 0; steps < n && way.dot(at(k + 1) - at(k)) > 0; ++steps) ++k;
  };
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 along = (at(k + 1) - at(k)).normalized();
    const Vec2 up(-along.y(), along.x());
    right = std::max(right, k);
    climb(right, along);
    top = std::max(top, right);
    climb(top, up);
    left = std::max(left, top);
    climb(left, -along);
    const double area = along.dot(at(right) - at(left)) * up.dot(at(top) - at(k));
    if (least >= 0 && area >= least) continue;
    least = area;
    best = along;
  }
  return best;
}

}  // namespace

UvMap convex_hull(UvMap points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  UvMap hull;
  add_chain(points.begin(), points.end(), 0, hull);
  add_chain(points.rbegin(), points.rend(), hull.size(), hull);
  return hull;
}

Box smallest_box(std::span<const Vec2> points) {
  assert(!points.empty());
  const UvMap hull = convex_hull({points.begin(), points.end()});
  return box_along(points, hull.size() < 2 ? Vec2(Vec2::UnitX()) : best_direction(hull));
}

Box squarest_box(std::span<const Vec2> points, double aspect) {
  const auto page_of = [&](const Box& box) {  // its width
    const Vec2& size = box.size;
    return std::min(std::max(size.x(), size.y() / aspect), std::max(size.y(), size.x() / aspect));
  };
  Box best = smallest_box(points);
  const UvMap hull = convex_hull({points.begin(), points.end()});
  for (int k = 0; k < kSquareAngles; ++k) {
    const double angle = k * std::numbers::pi / 2 / kSquareAngles;
    const Box box = box_along(hull, {std::cos(angle), std::sin(angle)});
    if (page_of(box) < page_of(best) * kSquareGain) best = box;
  }
  return best;
}

std::optional<Box> straight_box(std::span<const std::array<Vec2, 2>> sides) {
  const auto way = [](const std::array<Vec2, 2>& side) { return Vec2(side[1] - side[0]); };
  std::vector<Vec2> longest;
  double all = 0;
  for (const auto& side : sides) {
    longest.push_back(way(side));
    all += way(side).norm();
  }
  std::ranges::stable_sort(longest, std::greater(), &Vec2::squaredNorm);
  longest.resize(std::min(longest.size(), kStraightTries));
  Vec2 best = Vec2::Zero();
  double most = kMostlyStraight * all;
  for (const Vec2& along : longest) {
    double straight = 0;
    for (const auto& side : sides) {
      const Vec2 other = way(side);
      const double both = along.squaredNorm() * other.squaredNorm();
      if (std::abs(along.dot(other) * cross(along, other)) <= kStraight * both)
        straight += other.norm();
    }
    if (straight <= most) continue;
    most = straight;
    best = along;
  }
  if (best == Vec2::Zero()) return std::nullopt;
  return box_along(charts::points_of(sides), best.normalized());
}

Box resting_box(std::span<const std::array<Vec2, 2>> sides, Rotation rotation) {
  const std::optional<Box> straight =
      rotation == Rotation::none ? std::nullopt : straight_box(sides);
  if (straight) return *straight;
  const UvMap points = charts::points_of(sides);
  return rotation == Rotation::none ? box_along(points, Vec2::UnitX()) : smallest_box(points);
}

}  // namespace unwrapd::pack
