// A triangle is laid on its longest edge: that edge becomes the x axis, and the third corner keeps
// its foot and height. The base never vanishes, so needles and caps lose no digits.
#include "core/measure/rest_triangle.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace unwrapd::measure {
namespace {

struct Corners {
  std::array<Vec3, 3> p;
};

Corners corners_of(std::span<const Vec3> positions, const Triangle& face) {
  const auto at = [&](int i) { return positions[static_cast<std::size_t>(face[i])]; };
  return {{at(0), at(1), at(2)}};
}

std::size_t longest_edge(const Corners& c) {
  std::size_t longest = 0;
  double best = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = (c.p[(i + 1) % 3] - c.p[i]).squaredNorm();
    if (length > best) best = length, longest = i;
  }
  return longest;
}

RestTriangle lay_flat(const Corners& c) {
  const std::size_t k = longest_edge(c);
  const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  const Vec3 base = c.p[k1] - c.p[k];
  const Vec3 side = c.p[k2] - c.p[k];
  const double length = base.norm();
  assert(length > 0);
  const double foot = side.dot(base) / length;
  const double height = std::max(side.cross(base).norm() / length, kMinHeight * length);

  std::array<Vec2, 3> x;
  x[k] = Vec2(0, 0);
  x[k1] = Vec2(length, 0);
  x[k2] = Vec2(foot, height);

  RestTriangle rest;
  rest.area = 0.5 * length * height;
  for (std::size_t i = 0; i < 3; ++i) rest.edge[i] = x[i] - x[(i + 1) % 3];
  for (std::size_t i = 0; i < 3; ++i)
    rest.cot[i] = -rest.edge[(i + 1) % 3].dot(rest.edge[(i + 2) % 3]) / (2 * rest.area);
  return rest;
}

}  // namespace

std::vector<RestTriangle> flatten(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                  Executor& executor) {
  std::vector<RestTriangle> rest(faces.size());
  for_each_part(rest.size(), executor, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) rest[t] = lay_flat(corners_of(positions, faces[t]));
  });
  return rest;
}

std::vector<RestTriangle> flatten(const TriMesh& mesh, const std::stop_token& stop) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return flatten(mesh.positions, mesh.faces, job);
}

double face_area(const TriMesh& mesh,
                 const Triangle& face) {  // a copy of the corners would be five times slower
  const auto at = [&](int i) -> const Vec3& {
    return mesh.positions[static_cast<std::size_t>(face[static_cast<std::size_t>(i)])];
  };
  const Vec3 first = at(1) - at(0), second = at(2) - at(0);
  return 0.5 * first.cross(second).norm();
}

double area_of(std::span<const RestTriangle> rest) {
  double area = 0;
  for (const RestTriangle& one : rest) area += one.area;
  return area;
}

double surface_area(const TriMesh& mesh, Executor& executor) {
  std::vector<double> sums(part_count(mesh.faces.size()), 0.0);
  for_each_part(mesh.faces.size(), executor,
                [&](std::size_t k, std::size_t begin, std::size_t end) {
                  for (std::size_t t = begin; t < end; ++t)
                    sums[k] += face_area(mesh, mesh.faces[t]);
                });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double surface_area(const TriMesh& mesh) {
  SerialExecutor serial;
  return surface_area(mesh, serial);
}

}  // namespace unwrapd::measure
