#pragma once
// What a seam costs where the caller has painted that it should rather not run (ADR 0067), and
// where the caller has said that none may run (ADR 0074).

#include <span>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::charts {

/// A seam of painted value 1 counts as so many times its length more.
inline constexpr double kAvoidance = 8;

/// Chart::avoid of an edge that is kept: a seam there costs more than any detour. Painted values
/// end at 1, and means of both stay above that.
inline constexpr double kKept = 1000;

inline bool is_kept(std::span<const double> avoid, Index h) {
  return !avoid.empty() && avoid[static_cast<std::size_t>(h)] > 1;
}

/// How many times its length a seam along half-edge h counts. avoid: see Chart::avoid.
inline double seam_weight(std::span<const double> avoid, Index h) {
  return avoid.empty() ? 1 : 1 + kAvoidance * avoid[static_cast<std::size_t>(h)];
}

/// Chart::avoid of a surface's component: the mean of both corners of each half-edge and of those
/// across the edge, which other vertices of the input may have.
inline std::vector<double> avoid_of(const Chart& chart, const Surface& surface) {
  if (surface.seam_avoid.empty()) return {};
  const auto value = [&](const Triangle& face, std::size_t i) {
    return surface.seam_avoid[static_cast<std::size_t>(face[i])];
  };
  std::vector<double> own;
  for (const Index t : chart.face_source)
    for (std::size_t i = 0; i < 3; ++i) {
      const Triangle& face = surface.mesh.faces[static_cast<std::size_t>(t)];
      own.push_back((value(face, i) + value(face, (i + 1) % 3)) / 2);
    }
  std::vector<double> mean = own;
  for (std::size_t h = 0; h < own.size(); ++h)
    if (const Index twin = chart.halfedges.twin[h]; twin != kNoTwin)
      mean[h] = (own[h] + own[static_cast<std::size_t>(twin)]) / 2;
  return mean;
}

}  // namespace unwrapd::charts
