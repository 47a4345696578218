#pragma once
// Places for the vertices of a disk, for the tests of what holds them.

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve {

/// count different vertices over the page, where the vertex lies in the x-y plane, but not quite.
inline std::vector<HardConstraint> scattered(const Disk& disk, std::size_t count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> off(-0.02, 0.02);
  std::vector<Index> vertex(disk.positions.size());
  std::iota(vertex.begin(), vertex.end(), 0);
  std::shuffle(vertex.begin(), vertex.end(), rng);
  std::vector<HardConstraint> points;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3& p = disk.positions[std::size_t(vertex[k])];
    points.push_back({vertex[k], Vec2(0.5 + 0.6 * p.x() + off(rng), 0.5 + 0.6 * p.y() + off(rng))});
  }
  return points;
}

inline std::vector<SoftConstraint> as_soft_constraints(const std::vector<HardConstraint>& points,
                                                       double weight) {
  std::vector<SoftConstraint> soft;
  for (const HardConstraint& p : points) soft.push_back({p.vertex, p.at, weight});
  return soft;
}

inline double greatest_gap(const UvMap& a, const UvMap& b) {
  double gap = 0;
  for (std::size_t v = 0; v < a.size(); ++v) gap = std::max(gap, (a[v] - b[v]).norm());
  return gap;
}

}  // namespace unwrapd::solve
