// Energies as closed formulas of the singular values (App. A). The solver gets its energy from the
// local step; these are a second way to compute the same values.
#include "core/measure/energy.hpp"

#include <cassert>

namespace unwrapd::measure {
namespace {

template <typename Density>
double integrate(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                 std::span<const Vec2> uv, const Density& density) {
  assert(rest.size() == faces.size());
  double sum = 0;
  for (std::size_t t = 0; t < faces.size(); ++t) {
    const Jacobian j = jacobian(rest[t], uv_edges(faces[t], uv));
    sum += rest[t].area * density(j.sigma_max(), j.sigma_min());
  }
  return sum;
}

}  // namespace

double arap_energy(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                   std::span<const Vec2> uv) {
  return integrate(rest, faces, uv,
                   [](double s1, double s2) { return (s1 - 1) * (s1 - 1) + (s2 - 1) * (s2 - 1); });
}

double asap_energy(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                   std::span<const Vec2> uv) {
  return integrate(rest, faces, uv, [](double s1, double s2) { return (s1 - s2) * (s1 - s2) / 2; });
}

}  // namespace unwrapd::measure
