#include "core/solve/repair/sizes.hpp"

#include <algorithm>
#include <cmath>

#include "core/measure/jacobian.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kLeastStretch = 1e-12;

}  // namespace

std::vector<double> sizes_around(std::span<const Triangle> faces,
                                 std::span<const measure::RestTriangle> rest,
                                 std::span<const Vec2> uv) {
  std::vector<double> sum(uv.size(), 0), count(uv.size(), 0);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const measure::Jacobian j = measure::jacobian(rest[t], measure::uv_edges(faces[t], uv));
    const double stretch = std::hypot(j.turn_scale(), j.deformation());
    for (Index v : faces[t]) {
      sum[v] += std::log(std::max(kLeastStretch, stretch));
      ++count[v];
    }
  }
  std::vector<double> size;
  size.reserve(faces.size());
  for (const auto& [a, b, c] : faces)
    size.push_back(std::exp((sum[a] + sum[b] + sum[c]) / (count[a] + count[b] + count[c])));
  return size;
}

}  // namespace unwrapd::solve::repair
