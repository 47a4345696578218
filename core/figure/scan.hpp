#pragma once
// Exact scan conversion of triangles. Corners are snapped to whole steps, so that which samples lie
// inside is a question about integers: two triangles with a common edge share no sample and leave
// none out (the rule of top and left edges, as in OpenGL and Direct3D).
// A pixel has kSamples x kSamples samples; its colour is their mean. Coverage by formula would be
// smoother for one triangle, but says nothing of which of two is in front.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

using ScreenPoint = std::array<std::int32_t, 2>;  ///< x to the right, y down, in steps
using ScreenTriangle = std::array<ScreenPoint, 3>;

inline constexpr int kSamples = 4;                           ///< along a pixel's side
inline constexpr int kSampleSteps = 16;                      ///< from one sample to the next
inline constexpr int kPixelSteps = kSamples * kSampleSteps;  ///< a pixel's side
inline constexpr double kMaxScreen =
    (1 << 24) / static_cast<double>(kPixelSteps);  ///< pixels; beyond it is cut off

/// A place in pixels, snapped; NaN becomes 0.
inline ScreenPoint snapped(const Vec2& pixels) {
  const auto step = [](double x) {
    const double inside = std::clamp(std::isnan(x) ? 0 : x, -kMaxScreen, kMaxScreen);
    return static_cast<std::int32_t>(std::lround(kPixelSteps * inside));
  };
  return {step(pixels.x()), step(pixels.y())};
}

/// Samples [first, end) of a row or rows of a picture.
struct SampleRange {
  int first = 0;
  int end = 0;
};

namespace scan_detail {

inline std::int64_t floor_div(std::int64_t a, std::int64_t b) {  // b > 0
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/// Twice the signed area of (p, q, r), steps^2.
inline std::int64_t cross(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r) {
  return std::int64_t{q[0] - p[0]} * (r[1] - p[1]) - std::int64_t{q[1] - p[1]} * (r[0] - p[0]);
}

/// Leaves in `range` the samples of row y that lie on the inner side of the edge p -> q.
inline void cut(const ScreenPoint& p, const ScreenPoint& q, std::int64_t y, SampleRange& range) {
  const std::int64_t dx = q[0] - p[0], dy = q[1] - p[1];
  const bool owns_its_samples = dy < 0 || (dy == 0 && dx > 0);
  const std::int64_t c =
      dx * (y - p[1]) + dy * (p[0] - kSampleSteps / 2) - (owns_its_samples ? 0 : 1);
  const std::int64_t slope = kSampleSteps * dy;  // inside where c - slope * x >= 0
  if (slope > 0)
    range.end = static_cast<int>(std::min<std::int64_t>(range.end, floor_div(c, slope) + 1));
  if (slope < 0)
    range.first = static_cast<int>(std::max<std::int64_t>(range.first, -floor_div(c, -slope)));
  if (slope == 0 && c < 0) range.end = range.first;
}

}  // namespace scan_detail

/// The rows of samples that a triangle may touch.
inline SampleRange rows_of(const ScreenTriangle& t) {
  const auto [low, high] = std::minmax({t[0][1], t[1][1], t[2][1]});
  const auto row = [](std::int64_t y) {  // the first at y or below
    return static_cast<int>(scan_detail::floor_div(y + kSampleSteps / 2 - 1, kSampleSteps));
  };
  return {row(low), row(high) + 1};
}

/// Calls visit(row, SampleRange) for each row of samples of the triangle within rows and columns;
/// either orientation, and nothing for a triangle without area.
template <class Visit>
void scan(const ScreenTriangle& t, const SampleRange& rows, int columns, Visit visit) {
  const std::int64_t area = scan_detail::cross(t[0], t[1], t[2]);
  if (area == 0) return;
  const ScreenPoint &a = t[0], &b = t[area > 0 ? 1 : 2], &c = t[area > 0 ? 2 : 1];
  const SampleRange own = rows_of(t);
  for (int row = std::max(own.first, rows.first); row < std::min(own.end, rows.end); ++row) {
    const std::int64_t y = std::int64_t{row} * kSampleSteps + kSampleSteps / 2;
    SampleRange range{0, columns};
    scan_detail::cut(a, b, y, range);
    scan_detail::cut(b, c, y, range);
    scan_detail::cut(c, a, y, range);
    if (range.first < range.end) visit(row, range);
  }
}

/// The weights of a triangle's corners along a row of samples: inside, each is in [0, 1]; their sum
/// is 1. The triangle has an area.
class CornerWeights {
 public:
  CornerWeights(const ScreenTriangle& t, int row)
      : scale_(1 / static_cast<double>(scan_detail::cross(t[0], t[1], t[2]))),
        step_{std::int64_t{kSampleSteps} * (t[1][1] - t[2][1]),
              std::int64_t{kSampleSteps} * (t[2][1] - t[0][1])} {
    const ScreenPoint first = {kSampleSteps / 2, row * kSampleSteps + kSampleSteps / 2};
    start_ = {scan_detail::cross(t[1], t[2], first), scan_detail::cross(t[2], t[0], first)};
  }

  [[nodiscard]] std::array<double, 3> at(int column) const {
    const double a = scale_ * static_cast<double>(start_[0] + column * step_[0]);
    const double b = scale_ * static_cast<double>(start_[1] + column * step_[1]);
    return {a, b, 1 - a - b};
  }

 private:
  double scale_;
  std::array<std::int64_t, 2> step_;  // from one sample to the next
  std::array<std::int64_t, 2> start_;
};

}  // namespace unwrapd::figure
