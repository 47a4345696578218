#pragma once
// Surfaces cut into charts, and what must hold of these, by checks that share no code with core.

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/measure/overlaps.hpp"
#include "core/segment/segment_charts.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {

struct Cut {
  std::vector<charts::Charts> surfaces;
  std::optional<Note> note;
};

inline Cut cut_up(const TriMesh& mesh, const SegmentOptions& options = {},
                  const SegmentWatch& watch = {}) {
  SerialExecutor serial;
  Cut result{{charts::components_of(shapes::surface_of(mesh), {})}, {}};
  result.note = segment_charts(result.surfaces, options, watch, serial);
  return result;
}

/// A disk by counting: its Euler characteristic from sets of vertices and edges.
inline void expect_disk(const charts::Chart& chart) {
  std::set<Index> vertices;
  std::set<std::pair<Index, Index>> edges;
  for (const Triangle& face : chart.mesh.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      vertices.insert(face[i]);
      edges.insert(std::minmax(face[i], face[(i + 1) % 3]));
    }
  const auto euler = static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) +
                     static_cast<int>(chart.mesh.faces.size());
  EXPECT_GE(chart.loops.size(), 1U);
  EXPECT_EQ(euler, 2 - static_cast<int>(chart.loops.size()));
}

/// Every pair of triangles, without a tree.
inline void expect_no_overlap(const charts::Chart& chart) {
  const auto corners = [&](std::size_t t) {
    const auto& [a, b, c] = chart.mesh.faces[t];
    return std::array{chart.start[std::size_t(a)], chart.start[std::size_t(b)],
                      chart.start[std::size_t(c)]};
  };
  for (std::size_t s = 0; s < chart.mesh.faces.size(); ++s) {
    const auto [a, b, c] = corners(s);
    EXPECT_GT((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(), 0);
    for (std::size_t t = 0; t < s; ++t) ASSERT_FALSE(measure::overlap(corners(s), corners(t)));
  }
}

inline void expect_sound(const Cut& cut, std::size_t face_count) {
  std::vector<int> seen(face_count, 0);
  for (const charts::Chart& chart : cut.surfaces.front().charts) {
    expect_disk(chart);
    for (const Index t : chart.face_source) ++seen[std::size_t(t)];
    if (!chart.start.empty()) expect_no_overlap(chart);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ptrdiff_t(face_count));
}

inline std::vector<std::vector<Index>> faces_of(const Cut& cut) {
  std::vector<std::vector<Index>> faces;
  for (const charts::Chart& chart : cut.surfaces.front().charts) faces.push_back(chart.face_source);
  return faces;
}

/// {D_angle, D_area} of all starts by singular values of 3D-to-2D Jacobians, each chart scaled to
/// its own area: the formula of the paper, not the one that the code sums.
inline std::array<double, 2> distortion_by_svd(const Cut& cut) {
  double total = 0, angle = 0, area = 0;
  for (const charts::Chart& chart : cut.surfaces.front().charts) {
    double own = 0, mapped = 0, inverse = 0;
    for (const auto& [a, b, c] : chart.mesh.faces) {
      const Vec3 ab = chart.mesh.positions[std::size_t(b)] - chart.mesh.positions[std::size_t(a)];
      const Vec3 ac = chart.mesh.positions[std::size_t(c)] - chart.mesh.positions[std::size_t(a)];
      const Vec3 x = ab.normalized(), y = ab.cross(ac).cross(ab).normalized();
      Eigen::Matrix2d rest, image;
      rest << ab.dot(x), ac.dot(x), 0, ac.dot(y);
      image.col(0) = chart.start[std::size_t(b)] - chart.start[std::size_t(a)];
      image.col(1) = chart.start[std::size_t(c)] - chart.start[std::size_t(a)];
      const Eigen::Vector2d sigma =
          Eigen::JacobiSVD<Eigen::Matrix2d>(image * rest.inverse()).singularValues();
      const double weight = ab.cross(ac).norm() / 2;
      own += weight;
      mapped += weight * sigma.prod();
      inverse += weight / sigma.prod();
      angle += weight * (sigma[0] / sigma[1] + sigma[1] / sigma[0]);
    }
    total += own;
    area += own + inverse * mapped / own;
  }
  return {angle / total, area / total};
}

}  // namespace unwrapd::segment
