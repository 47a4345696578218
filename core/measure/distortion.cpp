// Distortion of a map (Sec. 6). A flipped triangle makes the printed formulas negative and their
// sums meaningless, so D is computed on |sigma| and the flips are counted beside it.
#include "core/measure/distortion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace unwrapd::measure {
namespace {

/// The height over the longest side is that side's length divided by the sum of the cotangents at
/// its ends, which are the two greatest.
bool is_degenerate(const RestTriangle& rest) {
  const auto& [a, b, c] = rest.cot;
  return (a + b + c - std::min({a, b, c})) * kMeasurable >= 1;
}

/// A range of the faces, and the map of all.
struct Faces {
  std::span<const RestTriangle> rest;
  std::span<const Triangle> corners;
  std::span<const Vec2> uv;

  [[nodiscard]] Faces part(std::size_t begin, std::size_t end) const {
    return {rest.subspan(begin, end - begin), corners.subspan(begin, end - begin), uv};
  }
  [[nodiscard]] Jacobian jacobian_of(std::size_t t) const {
    return jacobian(rest[t], uv_edges(corners[t], uv));
  }
};

/// The sums of a block without the floor of singular values, and the data to tell whether that is
/// valid.
struct Block {
  DistortionSums sums;
  double squares = 0;  ///< sum of A_t |J|^2 of measured triangles
  double least_determinant = std::numeric_limits<double>::infinity(), greatest_norm = 0;

  /// sigma_min >= det J / |J|
  [[nodiscard]] bool is_above(double floor) const {
    return least_determinant > floor * std::sqrt(greatest_norm);
  }
};

/// No roots: sigma_max / sigma_min + sigma_min / sigma_max = |J|^2 / det J.
Block sum_up(const Faces& faces) {
  Block block;
  DistortionSums& sums = block.sums;
  for (std::size_t t = 0; t < faces.rest.size(); ++t) {
    const Jacobian j = faces.jacobian_of(t);
    const double a = faces.rest[t].area, determinant = j.determinant(), norm = j.squared_norm();
    const double inverse = 1 / determinant, shape = norm * inverse;
    sums.area += a;
    sums.uv_area += a * std::abs(determinant);
    if (!(determinant > 0)) ++sums.flipped;
    if (is_degenerate(faces.rest[t])) {
      ++sums.degenerate;
      continue;
    }
    sums.measured += a;
    sums.measured_uv += a * std::abs(determinant);
    block.squares += a * norm;
    sums.angle += a * shape;
    sums.inverse += a * inverse;
    sums.stretch += a * (shape * inverse) / 2;
    block.least_determinant = std::min(block.least_determinant, determinant);
    block.greatest_norm = std::max(block.greatest_norm, norm);
  }
  return block;
}

/// The same for a block in which a triangle is flipped or below the floor.
void add_floored(const Faces& faces, double floor, DistortionSums& sums) {
  for (std::size_t t = 0; t < faces.rest.size(); ++t) {
    const Jacobian j = faces.jacobian_of(t);
    const double a = faces.rest[t].area, sigma_min = j.sigma_min();
    if (!(sigma_min > 0)) ++sums.flipped;
    if (is_degenerate(faces.rest[t])) continue;
    const double s1 = std::max(j.sigma_max(), floor), s2 = std::max(std::abs(sigma_min), floor);
    sums.measured_uv += a * s1 * s2;
    sums.angle += a * (s1 / s2 + s2 / s1);
    sums.inverse += a / (s1 * s2);
    sums.stretch += a * (1 / (s1 * s1) + 1 / (s2 * s2)) / 2;
  }
}

/// What kMinSingularValue comes to. The mean stretch is the root mean square of the singular
/// values, which a map onto a line has, too: its UV area is 0. A map onto a point has none: 0.
double floor_of(const std::vector<Block>& blocks) {
  double squares = 0, measured = 0;
  for (const Block& block : blocks) squares += block.squares, measured += block.sums.measured;
  return squares > 0 ? kMinSingularValue * std::sqrt(squares / (2 * measured)) : 0;
}

/// A map onto a point has no scale: what it comes to depends on the maps that it is summed up with.
DistortionSums sums_of_point(const std::vector<Block>& blocks) {
  DistortionSums sums;
  for (const Block& block : blocks) {
    sums.area += block.sums.area;
    sums.uv_area += block.sums.uv_area;
    sums.measured += block.sums.measured;
    sums.flipped += block.sums.flipped;
    sums.degenerate += block.sums.degenerate;
  }
  sums.collapsed = sums.measured;
  sums.angle = sums.measured * (1 / kMinSingularValue + kMinSingularValue);
  return sums;
}

}  // namespace

DistortionSums& DistortionSums::operator+=(const DistortionSums& other) {
  area += other.area;
  uv_area += other.uv_area;
  measured += other.measured;
  measured_uv += other.measured_uv;
  angle += other.angle;
  inverse += other.inverse;
  stretch += other.stretch;
  collapsed += other.collapsed;
  flipped += other.flipped;
  degenerate += other.degenerate;
  return *this;
}

DistortionSums DistortionSums::in_units(double scale) const {
  const double square = scale * scale;
  DistortionSums sums = *this;
  for (double* areas : {&sums.area, &sums.measured, &sums.angle, &sums.collapsed}) *areas *= square;
  for (double* products : {&sums.inverse, &sums.stretch}) *products *= square * square;
  return sums;
}

double uv_area(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
               std::span<const Vec2> uv, Executor& executor) {
  std::vector<double> sums(part_count(faces.size()), 0.0);
  for_each_part(faces.size(), executor, [&](std::size_t k, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      sums[k] += rest[t].area * std::abs(jacobian(rest[t], uv_edges(faces[t], uv)).determinant());
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double uv_area(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
               std::span<const Vec2> uv) {
  SerialExecutor serial;
  return uv_area(rest, faces, uv, serial);
}

DistortionSums distortion_sums(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                               std::span<const Vec2> uv, Executor& executor) {
  assert(rest.size() == faces.size());
  const Faces all{rest, faces, uv};
  std::vector<Block> blocks(part_count(faces.size()));
  for_each_part(faces.size(), executor, [&](std::size_t k, std::size_t begin, std::size_t end) {
    blocks[k] = sum_up(all.part(begin, end));
  });
  const double floor = floor_of(blocks);
  if (floor == 0) return sums_of_point(blocks);
  const auto is_above = [&](const Block& block) { return block.is_above(floor); };
  if (!std::ranges::all_of(blocks, is_above))
    for_each_part(faces.size(), executor, [&](std::size_t k, std::size_t begin, std::size_t end) {
      if (is_above(blocks[k])) return;
      DistortionSums& sums = blocks[k].sums;
      sums.measured_uv = sums.angle = sums.inverse = sums.stretch = 0, sums.flipped = 0;
      add_floored(all.part(begin, end), floor, blocks[k].sums);
    });
  DistortionSums sums;
  for (const Block& block : blocks) sums += block.sums;
  return sums;
}

DistortionSums distortion_sums(const TriMesh& mesh, std::span<const Vec2> uv, Executor& executor) {
  std::vector<Triangle> faces;
  for (const Triangle& face : mesh.faces)
    if (face_area(mesh, face) > 0) faces.push_back(face);
  DistortionSums sums;
  if (!faces.empty())
    sums = distortion_sums(flatten(mesh.positions, faces, executor), faces, uv, executor);
  sums.degenerate += static_cast<Index>(mesh.faces.size() - faces.size());
  return sums;
}

DistortionSums distortion_sums(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                               std::span<const Vec2> uv, const std::stop_token& stop) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return distortion_sums(rest, faces, uv, job);
}

Distortion distortion(const DistortionSums& sums) {
  if (!(sums.measured > 0)) return {.flipped = sums.flipped, .degenerate = sums.degenerate};
  const double scale2 = sums.measured_uv / sums.measured;  // square of the mean stretch
  const double lost = sums.collapsed / sums.measured / (kMinSingularValue * kMinSingularValue);
  return {.angle = std::max(2.0, sums.angle / sums.measured),
          .area = std::max(2.0, 1 + scale2 * sums.inverse / sums.measured + lost),
          .stretch = std::sqrt(scale2 * sums.stretch / sums.measured + lost),
          .flipped = sums.flipped,
          .degenerate = sums.degenerate};
}

}  // namespace unwrapd::measure
