#include "core/solve/lay_out.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/measure/distortion.hpp"
#include "core/solve/conformal.hpp"

namespace unwrapd {
namespace {

/// Corner 0 at the origin, corner 1 at (base, 0), corner 2 at apex, above the base.
RestTriangle triangle_at(double base, const Vec2& apex) {
  RestTriangle t;
  const Vec2 b(base, 0);
  t.edge = {Vec2(-b), Vec2(b - apex), apex};
  const double twice_area = base * apex.y();
  for (std::size_t i = 0; i < 3; ++i)  // facing edge i: the corner between the two others
    t.cot[i] = -t.edge[(i + 1) % 3].dot(t.edge[(i + 2) % 3]) / twice_area;
  t.area = twice_area / 2;
  return t;
}

}  // namespace

UvMap lay_out(const Disk& disk, std::vector<RestTriangle> flat) {
  Disk other = disk;
  other.rest = std::move(flat);
  UvMap uv = conformal_map(other, Pins::diameter);
  const double area = uv_area(disk.rest, disk.faces, uv);
  for (Vec2& u : uv) u /= std::sqrt(area);
  return uv;
}

RestTriangle triangle_of_lengths(const std::array<double, 3>& l) {
  const double foot = (l[0] * l[0] + l[2] * l[2] - l[1] * l[1]) / (2 * l[0]);
  const double height = std::sqrt(std::max(0.0, (l[2] - foot) * (l[2] + foot)));
  const double longest = *std::max_element(l.begin(), l.end());
  return triangle_at(l[0], {foot, std::max(height, kMinHeight * longest)});
}

RestTriangle triangle_of_angles(const std::array<double, 3>& angle) {
  const double unit = std::numbers::pi / (angle[0] + angle[1] + angle[2]);
  const std::array<double, 3> sine{std::sin(unit * angle[0]), std::sin(unit * angle[1]),
                                   std::sin(unit * angle[2])};
  const double longest = *std::max_element(sine.begin(), sine.end());
  const double height = std::max(sine[1] * sine[0], kMinHeight * longest * sine[2]);
  RestTriangle t = triangle_at(sine[2], {sine[1] * std::cos(unit * angle[0]), height});
  const double scale = 1 / std::sqrt(t.area);
  for (Vec2& e : t.edge) e *= scale;
  t.area = 1;
  return t;
}

}  // namespace unwrapd
