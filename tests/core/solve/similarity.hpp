#pragma once
// Maps compared up to a similarity of the plane.

#include <algorithm>
#include <complex>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::solve {

/// The greatest distance between points of b and those of a after the turn, scale and shift that
/// bring a closest to b in least squares.
inline double gap_up_to_similarity(const UvMap& a, const UvMap& b) {
  using Point = std::complex<double>;
  const auto at = [](const UvMap& uv, std::size_t v) { return Point(uv[v].x(), uv[v].y()); };
  const double n = double(a.size());
  Point mean_a = 0, mean_b = 0, product = 0;
  for (std::size_t v = 0; v < a.size(); ++v) mean_a += at(a, v) / n, mean_b += at(b, v) / n;
  double norm = 0, gap = 0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    product += std::conj(at(a, v) - mean_a) * (at(b, v) - mean_b);
    norm += std::norm(at(a, v) - mean_a);
  }
  for (std::size_t v = 0; v < a.size(); ++v)
    gap = std::max(gap, std::abs(at(b, v) - mean_b - product / norm * (at(a, v) - mean_a)));
  return gap;
}

}  // namespace unwrapd::solve
