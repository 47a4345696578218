// Thurston's metric as Chow and Luo 2003, Jin, Kim, Luo, Gu 2008 use it. The radii start from the
// mean, over the faces at a vertex, of the distance to the points where the incircle touches, and
// then minimise sum ((l - l') / l)^2, l' being the length nearest to l that both circles allow:
// [sqrt(r^2 + s^2), r + s]. Jacobi steps, so that the result does not depend on the order of
// vertices. Exact on right and acute triangulations that have such circles at all.
// With c free (inversive distance; Bowers, Stephenson 2004) any mesh has an exact start, but radii
// may then break triangles on the way to a flat metric: D_angle 5.96 on the Cow, 2.47 with circles.
// A vertex of three (four) faces can only become flat if the circles of its link cross at less than
// 60 (90) degrees: its link gets that much.
#include "core/solve/methods/circle_packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/base/metric.hpp"

namespace unwrapd::solve::methods {
namespace {

constexpr double kLeastLength = 1e-6;  // disk units: shorter edges count as this long
constexpr int kFittingSteps = 100;
constexpr double kDamping = 0.5;  // for Jacobi steps, in which both ends of an edge move at once
constexpr double kMostRefit = 8;  // of the start; vertices of three faces would shrink to nothing
constexpr double kLinkOfThree = 0.6, kLinkOfFour = 0.1;
constexpr double kMostLogRatio = 130;  // of radii in one triangle: products stay in range

std::size_t index(Index v) { return static_cast<std::size_t>(v); }

std::vector<EdgeLengths> lengths_of(const Disk& disk) {
  std::vector<EdgeLengths> length;
  for (const Triangle& face : disk.faces) {
    EdgeLengths l{};
    for (std::size_t i = 0; i < 3; ++i)
      l[i] = std::max(
          (disk.positions[index(face[i])] - disk.positions[index(face[(i + 1) % 3])]).norm(),
          kLeastLength);
    length.push_back(l);
  }
  return length;
}

/// The mean distance of each vertex to the points where the incircles of its faces touch their
/// sides.
std::vector<double> mean_radii(const Disk& disk, std::span<const EdgeLengths> length) {
  std::vector<double> sum(disk.positions.size(), 0.0), count(sum.size(), 0.0);
  for (std::size_t t = 0; t < length.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const EdgeLengths& l = length[t];
      const std::size_t v = index(disk.faces[t][i]);
      sum[v] += std::max((l[i] + l[(i + 2) % 3] - l[(i + 1) % 3]) / 2, kLeastLength / 2);
      ++count[v];
    }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] /= count[v];
  return sum;
}

/// The residual (l' - l) / l of an edge as a function of the radius r at its end, and its
/// derivative.
struct Demand {
  double residual = 0, slope = 0;
};

Demand demand(double r, double s, double length) {
  const double least = std::sqrt(r * r + s * s), most = r + s;
  if (least > length) return {(least - length) / length, r / (least * length)};
  if (most < length) return {(most - length) / length, 1 / length};
  return {};
}

/// One damped Gauss-Newton step of all radii at once. It bounds the distance of each radius from
/// its start.
void fit(const Disk& disk, std::span<const EdgeLengths> length, std::span<const double> start,
         std::vector<double>& radius) {
  std::vector<double> pull(radius.size(), 0.0), stiffness(radius.size(), 0.0);
  for (std::size_t t = 0; t < length.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t a = index(disk.faces[t][i]), b = index(disk.faces[t][(i + 1) % 3]);
      const Demand of_a = demand(radius[a], radius[b], length[t][i]);
      const Demand of_b = demand(radius[b], radius[a], length[t][i]);
      pull[a] -= of_a.residual * of_a.slope, stiffness[a] += of_a.slope * of_a.slope;
      pull[b] -= of_b.residual * of_b.slope, stiffness[b] += of_b.slope * of_b.slope;
    }
  }
  for (std::size_t v = 0; v < radius.size(); ++v)
    if (stiffness[v] > 0)
      radius[v] = std::clamp(radius[v] + kDamping * pull[v] / stiffness[v], start[v] / kMostRefit,
                             start[v] * kMostRefit);
}

/// The least cosine of crossing of each half-edge's edge, from the inner vertices opposite to it.
std::vector<double> least_crossing(const Disk& disk) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  const auto side_count = static_cast<Index>(3 * disk.faces.size());
  std::vector<double> least(index(side_count), 0.0);
  for (Index h = 0; h < side_count; ++h) {
    const std::size_t apex = index(apex_of(disk.faces, h));
    const Index valence = disk.corners.begin[apex + 1] - disk.corners.begin[apex];
    if (on_boundary[apex] != 0 || valence > 4) continue;
    least[index(h)] = valence == 4 ? kLinkOfFour : kLinkOfThree;
  }
  std::vector<EdgeSide> sides = edge_sides(
      disk.faces, [](Index) { return true; }, disk.stop);
  sort_by_edge(sides, disk.vertex_count(), disk.stop);
  for (std::size_t k = 1; k < sides.size(); ++k) {
    if (!on_one_edge(sides[k - 1], sides[k])) continue;
    double& a = least[index(sides[k - 1].halfedge)];
    double& b = least[index(sides[k].halfedge)];
    a = b = std::max(a, b);
  }
  return least;
}

/// One triangle of circles. r: radii; c[i]: the cosine of crossing of the circles at corners i and
/// i+1.
struct CircleTriangle {
  std::array<double, 3> r, c;

  [[nodiscard]] double bend(std::size_t i) const { return c[(i + 1) % 3] + c[i] * c[(i + 2) % 3]; }

  /// 2 A, from 4 A^2 as a sum without negative terms.
  [[nodiscard]] double twice_area() const {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      sum +=
          r[i] * r[i] * r[j] * r[j] * (1 - c[i] * c[i]) + 2 * bend(i) * r[i] * r[i] * r[j] * r[k];
    }
    return std::sqrt(sum);
  }

  [[nodiscard]] double angle(std::size_t i, double twice_area) const {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double product =
        r[i] * (r[i] + c[i] * r[j] + c[k] * r[k]) - c[j] * r[j] * r[k];  // of both sides at i
    return std::atan2(twice_area, product);
  }

  /// d angle_i / d log r_j = d angle_j / d log r_i: the distance of side i from the centre of the
  /// circle that crosses all three at right angles, over the side's length.
  [[nodiscard]] double weight(std::size_t i, double twice_area) const {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double square = r[i] * r[i] + r[j] * r[j] + 2 * c[i] * r[i] * r[j];
    const double sum = r[i] * r[j] * (1 - c[i] * c[i]) + r[k] * (r[i] * bend(i) + r[j] * bend(j));
    return r[i] * r[j] * sum / (twice_area * square);
  }
};

CircleTriangle circles(const Triangle& face, const CirclePacking& packing, std::size_t t) {
  std::array<double, 3> log{};
  for (std::size_t i = 0; i < 3; ++i) log[i] = packing.log_radius[index(face[i])];
  const double greatest = std::max({log[0], log[1], log[2]});
  CircleTriangle triangle{{}, packing.crossing[t]};
  for (std::size_t i = 0; i < 3; ++i)
    triangle.r[i] = std::exp(std::max(log[i] - greatest, -kMostLogRatio));
  return triangle;
}

}  // namespace

CirclePacking circle_packing(const Disk& disk) {
  const std::vector<EdgeLengths> length = lengths_of(disk);
  const std::vector<double> start = mean_radii(disk, length);
  std::vector<double> radius = start;
  for (int k = 0; k < kFittingSteps; ++k) fit(disk, length, start, radius);
  const std::vector<double> least = least_crossing(disk);
  CirclePacking packing;
  for (double r : radius) packing.log_radius.push_back(std::log(r));
  packing.crossing.resize(length.size());
  for (std::size_t h = 0; h < least.size(); ++h) {
    const Triangle& face = disk.faces[h / 3];
    const double r = radius[index(face[h % 3])], s = radius[index(face[(h + 1) % 3])];
    const double l = length[h / 3][h % 3];
    packing.crossing[h / 3][h % 3] =
        std::clamp((l * l - r * r - s * s) / (2 * r * s), least[h], 1.0);
  }
  return packing;
}

PackedAngles packed_angles(const Disk& disk, const CirclePacking& packing) {
  PackedAngles packed;
  packed.angle.reserve(disk.faces.size());
  packed.weight.reserve(3 * disk.faces.size());
  for (char on_boundary : boundary_vertices(disk))
    packed.curvature.push_back((on_boundary != 0 ? 1 : 2) * std::numbers::pi);
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    const CircleTriangle triangle = circles(disk.faces[t], packing, t);
    const double twice_area = triangle.twice_area();
    std::array<double, 3> angle{};
    for (std::size_t i = 0; i < 3; ++i) {
      angle[i] = triangle.angle(i, twice_area);
      packed.curvature[index(disk.faces[t][i])] -= angle[i];
      packed.weight.push_back(triangle.weight(i, twice_area));
    }
    packed.angle.push_back(angle);
  }
  return packed;
}

}  // namespace unwrapd::solve::methods
