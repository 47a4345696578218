// Garanzha et al. 2021 (barrier.hpp): epsilon shrinks with the worst of the triangles.
#include "core/solve/turn_over.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/cancel.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/newton.hpp"

namespace unwrapd {
namespace {

constexpr int kMostTurning = 90;       // Newton steps under the regularised barrier
constexpr int kPatience = 15;          // steps in which the flips must halve, after the first ones
constexpr double kEpsilonShare = 0.2;  // of the worst determinant
constexpr double kFirstEpsilon = 0.1;  // collapsed triangles open under a large one
constexpr double kLeastEpsilon = 1e-6;
constexpr double kStuck = 1e-5;  // relative fall of the energy in one step

/// The patch with targets that fit into its rim, which encloses the same area however the triangles
/// lie: else the best of maps has tiny determinants, and nothing tells them from flips.
BarrierMesh fitted(const BarrierMesh& mesh, const UvMap& uv) {
  double room = 0, wanted = 0;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    wanted += mesh.rest[t].area;
    room += mesh.rest[t].area * jacobian(mesh.rest[t], uv_edges(mesh.faces[t], uv)).determinant();
  }
  BarrierMesh fit = mesh;
  fit.springs.clear();  // they come when nothing is flipped
  const bool has_rim = mesh.free.count < static_cast<Index>(mesh.free.slot.size());
  if (has_rim && room > 0)
    for (RestTriangle& rest : fit.rest) rest = scaled(rest, std::sqrt(room / wanted));
  return fit;
}

}  // namespace

bool is_untangled(const BarrierMesh& mesh, std::span<const Vec2> uv) {
  return least_determinant(mesh, uv) > 0 && flipped_faces(mesh.faces, uv, mesh.stop).empty();
}

void turn_over(const BarrierMesh& patch, const MapIntent& intent, std::size_t enough, UvMap& uv) {
  const BarrierMesh mesh = fitted(patch, uv);
  Newton newton(mesh);
  std::size_t target = mesh.faces.size();
  double floor = kFirstEpsilon;
  for (int k = 0; k < kMostTurning; ++k, floor = std::max(kLeastEpsilon, floor / 2)) {
    const std::size_t flips = flipped_faces(mesh.faces, uv, mesh.stop).size();
    const double worst = least_determinant(mesh, uv);
    if (flips <= enough && (flips > 0 || worst > 0)) return;
    if (k > 0 && k % kPatience == 0 && flips > std::exchange(target, flips / 2)) return;
    throw_if_cancelled(intent.stop);
    const double epsilon = std::max(floor, -kEpsilonShare * worst);
    const double fall = newton.step(uv, {{0.0}, 1, epsilon});
    if (fall < kStuck && epsilon == kLeastEpsilon) return;
  }
}

}  // namespace unwrapd
