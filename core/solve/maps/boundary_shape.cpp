// Places the boundary by arc length, as Floater (1997) and Desbrun, Meyer, Alliez (2002) do.
//
// The square's corners are vertices: pure arc length would cut them off, and the chart would not
// reach the corners of the page. They are counted from the vertex where the surface's boundary is
// sharpest, so that a sheet with four corners keeps them. If an inner edge joins two vertices of
// one side, the triangles that it cuts off have no area. On a circle that cannot happen.
#include "core/solve/maps/boundary_shape.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace unwrapd::solve::maps {
namespace {

/// A loop that starts at one of its vertices: vertex[k] is at arc length arc[k]; the last entry is
/// the total.
struct Chain {
  std::vector<Index> vertex;
  std::vector<double> arc;
};

Index start_vertex(const Disk& disk, Index h) {
  return disk.faces[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(h % 3)];
}

double edge_length(const Disk& disk, Index h) {
  return disk.rest[static_cast<std::size_t>(h / 3)].edge[static_cast<std::size_t>(h % 3)].norm();
}

Chain chain_from(const Disk& disk, std::size_t first) {
  const BoundaryLoop& loop = disk.loops.front();
  Chain chain{{}, {0}};
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Index h = loop[(first + k) % loop.size()];
    chain.vertex.push_back(start_vertex(disk, h));
    chain.arc.push_back(chain.arc.back() + edge_length(disk, h));
  }
  return chain;
}

/// The surface's angle at a vertex: the sum over its corners, radians.
double angle_at(const Disk& disk, Index v) {
  double sum = 0;
  for (Index k = disk.corners.begin[static_cast<std::size_t>(v)];
       k < disk.corners.begin[static_cast<std::size_t>(v) + 1]; ++k) {
    const Index corner = disk.corners.corner[static_cast<std::size_t>(k)];
    const measure::RestTriangle& rest = disk.rest[static_cast<std::size_t>(corner / 3)];
    sum += std::atan2(1, rest.cot[static_cast<std::size_t>((corner + 1) % 3)]);
  }
  return sum;
}

/// The position in the loop of the least angle; the first of equal ones.
std::size_t sharpest(const Disk& disk) {
  const BoundaryLoop& loop = disk.loops.front();
  std::vector<double> angle;
  angle.reserve(loop.size());
  for (Index h : loop) angle.push_back(angle_at(disk, start_vertex(disk, h)));
  return static_cast<std::size_t>(std::min_element(angle.begin(), angle.end()) - angle.begin());
}

std::vector<HardConstraint> on_circle(const Chain& chain) {
  const double radius = std::sqrt(1 / std::numbers::pi);
  std::vector<HardConstraint> points;
  points.reserve(chain.vertex.size());
  for (std::size_t k = 0; k < chain.vertex.size(); ++k) {
    const double angle = 2 * std::numbers::pi * chain.arc[k] / chain.arc.back();
    points.push_back({chain.vertex[k], radius * Vec2(std::cos(angle), std::sin(angle))});
  }
  return points;
}

/// The k-th corner is the vertex nearest to k quarters of the loop that leaves a vertex for each
/// remaining corner.
std::vector<std::size_t> corners_of(const Chain& chain) {
  const std::size_t n = chain.vertex.size(), count = std::min<std::size_t>(4, n);
  std::vector<std::size_t> corner{0};
  for (std::size_t k = 1; k < count; ++k) {
    const double wanted = static_cast<double>(k) / 4 * chain.arc.back();
    std::size_t best = corner.back() + 1;
    for (std::size_t v = best; v + (count - k) <= n; ++v)
      if (std::abs(chain.arc[v] - wanted) < std::abs(chain.arc[best] - wanted)) best = v;
    corner.push_back(best);
  }
  return corner;
}

std::vector<HardConstraint> on_square(const Chain& chain) {
  const std::array<Vec2, 4> place{Vec2(-0.5, -0.5), Vec2(0.5, -0.5), Vec2(0.5, 0.5),
                                  Vec2(-0.5, 0.5)};
  std::vector<std::size_t> corner = corners_of(chain);
  const std::size_t count = corner.size();
  corner.push_back(chain.vertex.size());
  std::vector<HardConstraint> points;
  points.reserve(chain.vertex.size());
  for (std::size_t k = 0; k < count; ++k) {
    const double begin = chain.arc[corner[k]], end = chain.arc[corner[k + 1]];
    for (std::size_t v = corner[k]; v < corner[k + 1]; ++v) {
      const double t = end > begin ? (chain.arc[v] - begin) / (end - begin) : 0;
      points.push_back({chain.vertex[v], place[k] + t * (place[(k + 1) % 4] - place[k])});
    }
  }
  return points;
}

/// The sides of the square that contain p, one bit each.
int sides_of(const Vec2& p) {
  return (p.x() == -0.5 ? 1 : 0) | (p.x() == 0.5 ? 2 : 0) | (p.y() == -0.5 ? 4 : 0) |
         (p.y() == 0.5 ? 8 : 0);
}

}  // namespace

bool flattens_a_triangle(const Disk& disk, const std::vector<HardConstraint>& points) {
  std::vector<int> sides(disk.positions.size(), 0);
  for (const HardConstraint& p : points) sides[static_cast<std::size_t>(p.vertex)] = sides_of(p.at);
  std::vector<char> is_boundary(3 * disk.faces.size(), 0);
  for (Index h : disk.loops.front()) is_boundary[static_cast<std::size_t>(h)] = 1;
  for (std::size_t h = 0; h < is_boundary.size(); ++h) {
    const Triangle& face = disk.faces[h / 3];
    const int common = sides[static_cast<std::size_t>(face[h % 3])] &
                       sides[static_cast<std::size_t>(face[(h + 1) % 3])];
    if (is_boundary[h] == 0 && common != 0) return true;
  }
  return false;
}

std::vector<HardConstraint> boundary_points(const Disk& disk, BoundaryShape shape) {
  assert(shape != BoundaryShape::free);
  if (shape == BoundaryShape::circle) return on_circle(chain_from(disk, 0));
  return on_square(chain_from(disk, sharpest(disk)));
}

}  // namespace unwrapd::solve::maps
