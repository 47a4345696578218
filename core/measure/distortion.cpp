// Distortion of a map (Sec. 6). A flipped triangle makes the printed formulas negative and their
// sums meaningless, so D is computed on |sigma| and the flips are counted beside it.
#include "core/measure/distortion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace unwrapd {

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
                               std::span<const Vec2> uv) {
  assert(rest.size() == faces.size());
  DistortionSums sums;
  for (const RestTriangle& r : rest) sums.area += r.area;
  sums.uv_area = uv_area(rest, faces, uv);
  const double floor = std::max(kMinSingularValue * std::sqrt(sums.uv_area / sums.area), 1e-150);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const Jacobian j = jacobian(rest[t], uv_edges(faces[t], uv));
    const double s1 = std::max(j.sigma_max(), floor);
    const double s2 = std::max(std::abs(j.sigma_min()), floor);
    const double a = rest[t].area;
    sums.angle += a * (s1 / s2 + s2 / s1);
    sums.inverse += a / (s1 * s2);
    sums.stretch += a * (1 / (s1 * s1) + 1 / (s2 * s2)) / 2;
    if (!(j.sigma_min() > 0)) ++sums.flipped;
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
