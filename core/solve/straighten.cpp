// The boundary's directions, counted fourfold so that right angles agree, give the rectangle's; the
// vertices nearest to the box's corners are its corners. Each boundary vertex goes to its side at
// its share of the length. Inner vertices follow by a mean-value map of displacements, not of
// places: what already fits stays as it is.
#include "core/solve/straighten.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "core/measure/orientation.hpp"
#include "core/mesh/cross.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/maps/convex_map.hpp"

namespace unwrapd::solve {
namespace {

constexpr double kMostlyStraight = 0.9;  // length of the mean direction, 1 for a rectangle
constexpr double kNear = 0.1;            // of the shorter side: how far a vertex may be off

/// The boundary's vertices in order, and their places after a turn along the rectangle.
struct Border {
  std::vector<Index> vertices;
  UvMap at;

  [[nodiscard]] std::size_t next(std::size_t k) const { return (k + 1) % at.size(); }
};

/// The rotation that lays the boundary along the axes; empty if its sides have no two directions.
std::optional<std::complex<double>> turn_of(const Border& border) {
  std::complex<double> sum = 0;
  double length = 0;
  for (std::size_t k = 0; k < border.at.size(); ++k) {
    const Vec2 side = border.at[border.next(k)] - border.at[k];
    const double own = side.norm();
    if (!(own > 0)) continue;
    const std::complex<double> way(side.x() / own, side.y() / own);
    sum += own * way * way * way * way;
    length += own;
  }
  if (!(std::abs(sum) >= kMostlyStraight * length)) return std::nullopt;
  return std::polar(1.0, -std::arg(sum) / 4);
}

Vec2 turned(const Vec2& p, const std::complex<double>& turn) {
  const std::complex<double> q = turn * std::complex<double>(p.x(), p.y());
  return {q.real(), q.imag()};
}

using Corners = std::array<std::size_t, 4>;  ///< in Border, counter-clockwise from the lower left

/// The border's vertices nearest to the corners of its box, if they follow each other around it.
std::optional<Corners> corners_of(const Border& border, const Vec2& low, const Vec2& high) {
  const std::array<Vec2, 4> box = {low, Vec2(high.x(), low.y()), high, Vec2(low.x(), high.y())};
  Corners corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < border.at.size(); ++k)
      if (const double away = (border.at[k] - box[i]).norm(); away < least)
        least = away, corners[i] = k;
  }
  const std::size_t n = border.at.size();
  std::size_t around = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t steps = (corners[(i + 1) % 4] + n - corners[i]) % n;
    if (steps == 0) return std::nullopt;
    around += steps;
  }
  if (around != n) return std::nullopt;
  return corners;
}

/// A rectangle about the corners, of this area.
std::array<Vec2, 4> rectangle_of(const Border& border, const Corners& corners, double area) {
  const auto at = [&](std::size_t i) -> const Vec2& { return border.at[corners[i]]; };
  Vec2 size((at(1) - at(0)).norm() + (at(2) - at(3)).norm(),
            (at(2) - at(1)).norm() + (at(3) - at(0)).norm());
  size *= std::sqrt(area / size.prod());
  const Vec2 low = (at(0) + at(1) + at(2) + at(3)) / 4 - size / 2, high = low + size;
  return {low, Vec2(high.x(), low.y()), high, Vec2(low.x(), high.y())};
}

/// Where the border's vertices go; empty if one is far from its side, or not in their order.
std::optional<std::vector<HardConstraint>> targets_of(const Border& border, const Corners& corners,
                                                      const std::array<Vec2, 4>& rectangle) {
  const Vec2 size = rectangle[2] - rectangle[0];
  std::vector<HardConstraint> targets;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t begin = corners[i], end = corners[(i + 1) % 4];
    const Vec2 &from = rectangle[i], &to = rectangle[(i + 1) % 4];
    const Vec2 side = border.at[end] - border.at[begin];
    double last = -1;
    for (std::size_t k = begin; k != end; k = border.next(k)) {
      const double share = (border.at[k] - border.at[begin]).dot(side) / side.squaredNorm();
      const Vec2 target = from + share * (to - from);
      if (!(share > last && share < 1)) return std::nullopt;
      if (!((target - border.at[k]).norm() <= kNear * size.minCoeff())) return std::nullopt;
      targets.push_back({border.vertices[k], target});
      last = share;
    }
  }
  return targets;
}

double area_of(const Border& border) {
  double twice = 0;
  for (std::size_t k = 0; k < border.at.size(); ++k) {
    const Vec2 &a = border.at[k], &b = border.at[border.next(k)];
    twice += cross(a, b);
  }
  return twice / 2;
}

}  // namespace

std::optional<UvMap> straightened(const Disk& disk, std::span<const Vec2> uv) {
  if (disk.loops.size() != 1) return std::nullopt;
  Border border;
  for (const Index h : disk.loops[0]) {
    border.vertices.push_back(start_of(disk.faces, h));
    border.at.push_back(uv[static_cast<std::size_t>(border.vertices.back())]);
  }
  const auto turn = turn_of(border);
  if (!turn || !(area_of(border) > 0)) return std::nullopt;
  for (Vec2& p : border.at) p = turned(p, *turn);
  Vec2 low = border.at.front(), high = low;
  for (const Vec2& p : border.at) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const auto corners = corners_of(border, low, high);
  if (!corners) return std::nullopt;
  auto targets = targets_of(border, *corners, rectangle_of(border, *corners, area_of(border)));
  if (!targets) return std::nullopt;
  UvMap map(uv.begin(), uv.end());
  for (Vec2& p : map) p = turned(p, *turn);
  std::vector<HardConstraint> moves = *targets;
  for (HardConstraint& move : moves) move.at -= map[static_cast<std::size_t>(move.vertex)];
  const UvMap moved = maps::mean_value_map(disk, moves);
  for (std::size_t v = 0; v < map.size(); ++v) map[v] += moved[v];
  for (const HardConstraint& target : *targets)
    map[static_cast<std::size_t>(target.vertex)] = target.at;
  if (!measure::flipped_faces(disk.faces, map, disk.stop).empty()) return std::nullopt;
  return map;
}

}  // namespace unwrapd::solve
