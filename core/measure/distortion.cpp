// Distortion of a map (Sec. 6). A flipped triangle makes the printed formulas negative and their
// sums meaningless, so D is computed on |sigma| and the flips are counted beside it.
#include "core/measure/distortion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "core/cancel.hpp"

namespace unwrapd {
namespace {

/// Of one face: its singular values, by which it counts among all, and the area it counts with.
struct Stretches {
  double sigma_max, sigma_min, area;
};

}  // namespace

DistortionSums& DistortionSums::operator+=(const DistortionSums& other) {
  area += other.area;
  uv_area += other.uv_area;
  angle += other.angle;
  inverse += other.inverse;
  stretch += other.stretch;
  flipped += other.flipped;
  return *this;
}

double uv_area(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
               std::span<const Vec2> uv) {
  double sum = 0;
  for (std::size_t t = 0; t < faces.size(); ++t)
    sum += rest[t].area * std::abs(jacobian(rest[t], uv_edges(faces[t], uv)).determinant());
  return sum;
}

DistortionSums distortion_sums(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                               std::span<const Vec2> uv, const std::stop_token& stop) {
  assert(rest.size() == faces.size());
  DistortionSums sums;
  std::vector<Stretches> stretches;
  stretches.reserve(faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    look_now_and_then(t, stop);
    const Jacobian j = jacobian(rest[t], uv_edges(faces[t], uv));
    sums.area += rest[t].area;
    sums.uv_area += rest[t].area * std::abs(j.determinant());
    stretches.push_back({j.sigma_max(), j.sigma_min(), rest[t].area});
  }
  const double floor = std::max(kMinSingularValue * std::sqrt(sums.uv_area / sums.area), 1e-150);
  for (const auto& [sigma_max, sigma_min, a] : stretches) {
    const double s1 = std::max(sigma_max, floor), s2 = std::max(std::abs(sigma_min), floor);
    sums.angle += a * (s1 / s2 + s2 / s1);
    sums.inverse += a / (s1 * s2);
    sums.stretch += a * (1 / (s1 * s1) + 1 / (s2 * s2)) / 2;
    if (!(sigma_min > 0)) ++sums.flipped;
  }
  return sums;
}

Distortion distortion(const DistortionSums& sums) {
  if (!(sums.area > 0)) return {};
  const double scale2 = sums.uv_area / sums.area;  // square of the mean stretch
  return {.angle = std::max(2.0, sums.angle / sums.area),
          .area = std::max(2.0, 1 + scale2 * sums.inverse / sums.area),
          .stretch = std::sqrt(scale2 * sums.stretch / sums.area),
          .flipped = sums.flipped};
}

}  // namespace unwrapd
