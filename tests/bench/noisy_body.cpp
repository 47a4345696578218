// Surface nets (Gibson 1998) of a smooth field: one vertex in each cell that the surface crosses,
// at the mean of where it crosses the cell's edges, and a quadrilateral about each crossed edge of
// the grid. Marching cubes would leave slivers, which are another difficulty than noise.
#include "tests/bench/noisy_body.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "core/base/splitmix64.hpp"

namespace unwrapd::bench {
namespace {

constexpr double kReach = 1.15;       // the body lies within this of the origin
constexpr double kFacesByCell = 3.1;  // of the grid's side, squared

double smooth_least(double a, double b, double width) {
  const double near = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - near * near * width / 4;
}

double to_limb(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm() - radius;
}

double to_ring(const Vec3& p, double wide, double thick) {
  return std::hypot(std::hypot(p.x(), p.y()) - wide, p.z()) - thick;
}

/// Negative within.
double field(const Vec3& p) {
  const Vec3 hip(0, -0.2, 0);
  double d = p.norm() - 0.45;
  d = smooth_least(d, to_limb(p, Vec3::Zero(), {0.8, 0.25, 0.2}, 0.14), 0.12);
  d = smooth_least(d, to_limb(p, Vec3::Zero(), {-0.75, 0.35, -0.1}, 0.16), 0.12);
  d = smooth_least(d, to_limb(p, hip, {0.35, -0.85, 0.15}, 0.15), 0.1);
  d = smooth_least(d, to_limb(p, hip, {-0.35, -0.85, -0.15}, 0.15), 0.1);
  d = smooth_least(d, to_ring(p - Vec3(0, 0.6, 0), 0.26, 0.09), 0.1);
  return smooth_least(d, to_ring(p - Vec3(0.62, -0.15, 0.1), 0.2, 0.06), 0.06);
}

/// Negative within: a ball of limbs and rings drawn by the seed.
class SeededField {
 public:
  explicit SeededField(unsigned seed) {
    std::mt19937 random(seed);
    const auto draw = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    for (unsigned k = 0, limbs = 3 + random() % 4; k < limbs; ++k) {
      Vec3 to(draw(-1, 1), draw(-1, 1), draw(-1, 1));
      to *= draw(0.6, 0.9) / std::max(to.norm(), 0.1);
      limbs_.push_back({to, draw(0.1, 0.2)});
    }
    for (unsigned k = 0, rings = static_cast<unsigned>(random() % 3); k < rings; ++k) {
      const double angle = draw(0, 6.28);
      rings_.push_back({0.6 * Vec3(std::cos(angle), std::sin(angle), 0.1), draw(0.06, 0.1)});
    }
  }

  double operator()(const Vec3& p) const {
    double d = p.norm() - 0.45;
    for (const auto& [to, radius] : limbs_)
      d = smooth_least(d, to_limb(p, Vec3::Zero(), to, radius), 0.1);
    for (const auto& [at, thick] : rings_) d = smooth_least(d, to_ring(p - at, 0.22, thick), 0.08);
    return d;
  }

 private:
  std::vector<std::pair<Vec3, double>> limbs_, rings_;
};

using Cell = std::array<Index, 3>;

Cell moved(Cell cell, std::size_t axis, Index by) {
  cell[axis] += by;
  return cell;
}

class Nets {
 public:
  template <class Field>
  Nets(Index cells, const Field& field)
      : cells_(cells), step_(2 * kReach / cells), vertex_(count(cells), Index(-1)) {
    const Index corners = cells + 1;
    value_.reserve(count(corners));
    for (Index i = 0; i < corners; ++i)
      for (Index j = 0; j < corners; ++j)
        for (Index k = 0; k < corners; ++k)
          value_.push_back(static_cast<float>(field(point({i, j, k}))));
  }

  TriMesh mesh() {
    for_each_cell([this](const Cell& cell) { place_vertex(cell); });
    for_each_cell([this](const Cell& cell) {
      for (std::size_t axis = 0; axis < 3; ++axis) join_around(cell, axis);
    });
    return std::move(mesh_);
  }

 private:
  static std::size_t count(Index side) {
    return static_cast<std::size_t>(side) * static_cast<std::size_t>(side) *
           static_cast<std::size_t>(side);
  }
  static std::size_t place(const Cell& c, Index side) {
    return static_cast<std::size_t>((static_cast<std::int64_t>(c[0]) * side + c[1]) * side + c[2]);
  }
  [[nodiscard]] Vec3 point(const Cell& c) const {
    return step_ * Vec3(c[0], c[1], c[2]) - Vec3::Constant(kReach);
  }
  [[nodiscard]] double value(const Cell& corner) const { return value_[place(corner, cells_ + 1)]; }

  template <class Visit>
  void for_each_cell(Visit visit) {
    for (Index i = 0; i < cells_; ++i)
      for (Index j = 0; j < cells_; ++j)
        for (Index k = 0; k < cells_; ++k) visit(Cell{i, j, k});
  }

  /// At the mean of the crossings of the cell's twelve edges, where there are any.
  void place_vertex(const Cell& cell) {
    Vec3 sum = Vec3::Zero();
    int crossings = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (Index corner = 0; corner < 4; ++corner) {
        Cell a = moved(cell, (axis + 1) % 3, corner % 2);
        a = moved(a, (axis + 2) % 3, corner / 2);
        const Cell b = moved(a, axis, 1);
        const double at_a = value(a), at_b = value(b);
        if ((at_a < 0) == (at_b < 0)) continue;
        sum += point(a) + at_a / (at_a - at_b) * (point(b) - point(a));
        ++crossings;
      }
    if (crossings == 0) return;
    vertex_[place(cell, cells_)] = mesh_.vertex_count();
    mesh_.positions.push_back(sum / crossings);
  }

  /// The four cells about the grid's edge from this corner, where the surface crosses it.
  void join_around(const Cell& corner, std::size_t axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (corner[u] == 0 || corner[v] == 0) return;
    const bool is_within = value(corner) < 0;
    if (is_within == (value(moved(corner, axis, 1)) < 0)) return;
    const Cell before = moved(corner, u, -1);
    std::array<Index, 4> q{};
    const std::array<Cell, 4> around = {moved(before, v, -1), moved(corner, v, -1), corner, before};
    for (std::size_t k = 0; k < 4; ++k) q[k] = vertex_[place(around[k], cells_)];
    if (!is_within) std::swap(q[1], q[3]);
    mesh_.faces.push_back({q[0], q[1], q[2]});
    mesh_.faces.push_back({q[0], q[2], q[3]});
  }

  Index cells_;
  double step_;
  std::vector<float> value_;   // one a corner of the grid
  std::vector<Index> vertex_;  // one a cell; -1: none
  TriMesh mesh_;
};

/// In [-1, 1).
double drawn(std::size_t k) {
  return static_cast<double>(splitmix64((k + 1) * kGoldenStep) >> 11) * 0x1p-52 - 1;
}

void add_noise(TriMesh& mesh, double noise) {
  std::vector<Vec3> normal(mesh.positions.size(), Vec3::Zero());
  double length = 0;
  for (const Triangle& face : mesh.faces) {
    const Vec3 &a = mesh.positions[face[0]], &b = mesh.positions[face[1]],
               &c = mesh.positions[face[2]];
    for (const Index v : face) normal[v] += (b - a).cross(c - a);
    length += ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3;
  }
  length /= static_cast<double>(mesh.faces.size());
  for (std::size_t v = 0; v < normal.size(); ++v)
    mesh.positions[v] += noise * length * drawn(v) * normal[v].normalized();
}

}  // namespace

TriMesh noisy_body(double faces, double noise) {
  TriMesh mesh = Nets(static_cast<Index>(std::sqrt(faces / kFacesByCell)), field).mesh();
  add_noise(mesh, noise);
  return mesh;
}

TriMesh seeded_body(double faces, double noise, unsigned seed) {
  const SeededField body(seed);
  TriMesh mesh = Nets(static_cast<Index>(std::sqrt(faces / kFacesByCell)), body).mesh();
  add_noise(mesh, noise);
  return mesh;
}

}  // namespace unwrapd::bench
