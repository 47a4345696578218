// Each triangle is cut along the four sides of the page (Sutherland and Hodgman 1974).
#include "core/measure/page_area.hpp"

#include <array>
#include <cmath>

#include "core/mesh/cross.hpp"

namespace unwrapd::measure {
namespace {

/// A convex polygon: three corners, and at most one more for each side of the page.
struct Polygon {
  std::array<Vec2, 7> corners;
  std::size_t count = 0;

  void add(const Vec2& corner) { corners[count++] = corner; }
};

/// The part of a polygon with corner[axis] >= 0, or <= 1.
Polygon cut(const Polygon& polygon, Eigen::Index axis, bool is_above) {
  const double side = is_above ? 0 : 1;
  const auto is_inside = [&](const Vec2& p) {
    return is_above ? p[axis] >= side : p[axis] <= side;
  };
  Polygon part;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec2& from = polygon.corners[i];
    const Vec2& to = polygon.corners[(i + 1) % polygon.count];
    if (is_inside(from)) part.add(from);
    if (is_inside(from) == is_inside(to)) continue;
    const Vec2 &in = is_inside(from) ? from : to, &out = is_inside(from) ? to : from;
    Vec2 crossing = in + (side - in[axis]) / (out[axis] - in[axis]) * (out - in);  // out may be far
    crossing[axis] = side;
    part.add(crossing);
  }
  return part;
}

double area_of(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 2; i < polygon.count; ++i) {
    const Vec2 a = polygon.corners[i - 1] - polygon.corners[0];
    const Vec2 b = polygon.corners[i] - polygon.corners[0];
    twice += cross(a, b);
  }
  return std::abs(twice) / 2;
}

}  // namespace

double page_area(std::span<const Triangle> faces, std::span<const Vec2> uv) {
  double area = 0;
  for (const Triangle& face : faces) {
    Polygon polygon;
    for (const Index corner : face) polygon.add(uv[static_cast<std::size_t>(corner)]);
    for (const Eigen::Index axis : {0, 1})
      for (const bool is_above : {true, false}) polygon = cut(polygon, axis, is_above);
    area += area_of(polygon);
  }
  return area;
}

}  // namespace unwrapd::measure
