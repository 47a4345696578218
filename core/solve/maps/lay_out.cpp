#include "core/solve/maps/lay_out.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/maps/conformal.hpp"

namespace unwrapd::solve::maps {
namespace {

/// The rest triangle whose side k, its longest, runs from (0, 0) to (base, 0), and whose third
/// corner is at (foot, height).
measure::RestTriangle triangle_on(std::size_t k, double base, double foot, double height) {
  height = std::max(height, measure::kMinHeight * base);
  measure::RestTriangle t;
  t.edge[k] = Vec2(-base, 0);
  t.edge[(k + 1) % 3] = Vec2(base - foot, -height);
  t.edge[(k + 2) % 3] = Vec2(foot, height);
  t.area = base * height / 2;
  for (std::size_t i = 0; i < 3; ++i)  // edge i faces the corner between the two others
    t.cot[i] = -t.edge[(i + 1) % 3].dot(t.edge[(i + 2) % 3]) / (2 * t.area);
  return t;
}

std::size_t longest_of(const std::array<double, 3>& l) {
  return static_cast<std::size_t>(std::max_element(l.begin(), l.end()) - l.begin());
}

}  // namespace

UvMap lay_out(const Disk& disk, std::vector<measure::RestTriangle> flat) {
  Disk other = disk;
  other.rest = std::move(flat);
  UvMap uv = make_conformal_map(other, Pins::diameter);
  scale_to_area(disk, uv);
  return uv;
}

void scale_to_area(const Disk& disk, UvMap& uv) {
  const double rest_area = measure::area_of(disk.rest);
  const double area = measure::uv_area(disk.rest, disk.faces, uv);
  if (!(area > 0) || !std::isfinite(area))
    throw Error(ErrorCode::solver_failed,
                "the map fitted to the flattened triangles collapsed; choose another method");
  for (Vec2& u : uv) u *= std::sqrt(rest_area / area);
}

measure::RestTriangle triangle_of_lengths(const std::array<double, 3>& l) {
  const std::size_t k = longest_of(l);
  const double base = l[k], far = l[(k + 1) % 3], near = l[(k + 2) % 3];
  const double foot =
      std::clamp((base + (near - far) * ((near + far) / base)) / 2, 0.0, std::min(base, near));
  const double height = std::sqrt(std::max(0.0, (near - foot) * (near + foot)));
  return triangle_on(k, base, foot, height);
}

measure::RestTriangle triangle_of_angles(const std::array<double, 3>& angle) {
  const double unit = std::numbers::pi / (angle[0] + angle[1] + angle[2]);
  std::array<double, 3> sine{};  // of the angle that faces side i
  for (std::size_t i = 0; i < 3; ++i) sine[i] = std::sin(unit * angle[(i + 2) % 3]);
  const std::size_t k = longest_of(sine);
  const double near = sine[(k + 2) % 3], at = unit * angle[k];
  measure::RestTriangle t = triangle_on(k, sine[k], near * std::cos(at), near * std::sin(at));
  const double scale = 1 / std::sqrt(t.area);
  for (Vec2& e : t.edge) e *= scale;
  t.area = 1;
  return t;
}

}  // namespace unwrapd::solve::maps
