// An injective map may have gaps far narrower than the lattice that UVs are written on: the two
// sides of a slit in a plane, say. Rounding keeps them apart at vertices that face each other, but
// not where a vertex faces the middle of an edge. A step back into the chart, towards the middle of
// the vertex's own triangles, opens a gap on either side, and costs less than a texel.
// Rejected: other roundings of the same map (one more chance for each conflict, but none for all).
#include "core/guarantee/separate_rounded_boundaries.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/guarantee/quantize_uvs.hpp"
#include "core/linear/sparse.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::guarantee {
namespace {

constexpr std::array<double, 8> kDistances = {2, 4, 8, 16, 32, 64, 128, 256};  // steps
constexpr std::size_t kMostGapPairs = 1 << 16;
constexpr double kMostOfTheWay = 0.25;  // to the middle of a vertex's triangles

std::size_t index(Index v) { return static_cast<std::size_t>(v); }

std::vector<char> movable_vertices(const charts::Chart& chart,
                                   const std::vector<char>& constrained) {
  std::vector<char> movable(chart.mesh.positions.size(), 0);
  for (const BoundaryLoop& loop : chart.loops)
    for (Index h : loop) {
      const std::size_t v = index(start_of(chart.mesh.faces, h));
      movable[v] = constrained.empty() || constrained[v] == 0 ? 1 : 0;
    }
  return movable;
}

/// The movable vertices of overlapping triangles.
std::vector<char> pressed(const charts::Chart& chart, const std::vector<char>& movable,
                          const UvMap& uv, const std::stop_token& stop) {
  std::vector<char> in_conflict(movable.size(), 0);
  for (const auto& pair : measure::overlapping_pairs(chart.mesh.faces, uv, kMostGapPairs, stop))
    for (Index t : pair)
      for (Index v : chart.mesh.faces[index(t)]) in_conflict[index(v)] = movable[index(v)];
  return in_conflict;
}

/// The mean of the other corners of the triangles at v.
Vec2 middle(const charts::Chart& chart, const linear::VertexCorners& corners, std::size_t v,
            const UvMap& uv) {
  Vec2 sum = Vec2::Zero();
  const Index first = corners.begin[v], last = corners.begin[v + 1];
  for (Index k = first; k < last; ++k) {
    const Index h = corners.corner[index(k)];
    sum += uv[index(end_of(chart.mesh.faces, h))] + uv[index(apex_of(chart.mesh.faces, h))];
  }
  return sum / (2.0 * (last - first));
}

Vec2 drawn_back(const Vec2& from, const Vec2& towards, double distance) {
  const Vec2 way = towards - from;
  const double length = way.norm();
  return length > 0 ? Vec2(from + std::min(distance / length, kMostOfTheWay) * way) : from;
}

Vec2 on_lattice(const Vec2& u, double step) {
  return {std::round(u.x() / step) * step, std::round(u.y() / step) * step};
}

}  // namespace

bool separate_rounded_boundaries(const charts::Chart& chart, const std::vector<char>& constrained,
                                 UvMap& page_uv, const std::stop_token& stop) {
  const double step = uv_step(page_uv);
  const linear::VertexCorners corners =
      linear::vertex_corners(chart.mesh.faces, chart.mesh.vertex_count());
  const std::vector<char> movable = movable_vertices(chart, constrained);
  UvMap uv = page_uv;
  for (double distance : kDistances) {
    const std::vector<char> moves = pressed(chart, movable, uv, stop);
    if (std::ranges::find(moves, 1) == moves.end()) break;
    const UvMap before = uv;
    for (std::size_t v = 0; v < moves.size(); ++v)
      if (moves[v] != 0)
        uv[v] = on_lattice(
            drawn_back(before[v], middle(chart, corners, v, before), distance * step), step);
    if (!measure::flipped_faces(chart.mesh.faces, uv, stop).empty()) return false;
  }
  if (!measure::overlapping_pairs(chart.mesh.faces, uv, 1, stop).empty()) return false;
  page_uv = std::move(uv);
  return true;
}

}  // namespace unwrapd::guarantee
