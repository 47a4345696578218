// Garanzha et al. 2021 (barrier.hpp): epsilon shrinks with the worst of the triangles.
#include "core/solve/repair/turn_over.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/repair/newton.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr int kMostTurning = 90;  // Newton steps under the regularised barrier
constexpr int kPatience = 15;     // steps in which the flips must halve, after the first ones
constexpr std::size_t kLargePatch = 4096;  // faces; larger patches must show fewer flips by then
constexpr double kWholeWall = 3;       // beside an energy; with 1 single flips stay, with 10 steps
constexpr double kEpsilonShare = 0.2;  // of the worst determinant
constexpr double kFirstEpsilon = 0.1;  // collapsed triangles open under a large one
constexpr double kLeastEpsilon = 1e-6;
constexpr int kSweeps = 5;
constexpr double kSweep = 0.7;   // of the way
constexpr double kStuck = 1e-5;  // relative fall of the energy in one step

bool has_rim(const BarrierMesh& mesh) {
  return mesh.free.count < static_cast<Index>(mesh.free.slot.size());
}

/// The patch with targets that fit into its rim, which encloses the same area however the triangles
/// lie: else the best of maps has tiny determinants, and nothing tells them from flips.
BarrierMesh fit_targets(const BarrierMesh& mesh, const UvMap& uv) {
  double room = 0, wanted = 0;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    wanted += mesh.rest[t].area;
    room += mesh.rest[t].area *
            measure::jacobian(mesh.rest[t], measure::uv_edges(mesh.faces[t], uv)).determinant();
  }
  BarrierMesh fit = mesh;
  fit.soft.clear();  // soft constraints follow when nothing is flipped
  if (has_rim(mesh) && room > 0)
    for (measure::RestTriangle& rest : fit.rest) rest = scaled(rest, std::sqrt(room / wanted));
  return fit;
}

}  // namespace

UvMap even_out(const BarrierMesh& patch, UvMap uv) {
  std::vector<Vec2> sum(uv.size());
  std::vector<double> count(uv.size());
  for (int k = 0; k < kSweeps; ++k) {
    std::fill(sum.begin(), sum.end(), Vec2::Zero());
    std::fill(count.begin(), count.end(), 0);
    for (std::size_t t = 0; t < patch.faces.size(); ++t) {
      check_cancelled_every(t, patch.stop);
      const auto& [a, b, c] = patch.faces[t];
      const Vec2 all = uv[a] + uv[b] + uv[c];
      for (Index v : patch.faces[t]) sum[v] += all - uv[v], count[v] += 2;
    }
    for (std::size_t v = 0; v < uv.size(); ++v)
      if (patch.free.slot[v] != linear::kFixed) uv[v] += kSweep * (sum[v] / count[v] - uv[v]);
  }
  return uv;
}

bool is_untangled(const BarrierMesh& mesh, std::span<const Vec2> uv) {
  return least_determinant(mesh, uv) > 0 &&
         measure::flipped_faces(mesh.faces, uv, mesh.stop).empty();
}

void turn_over(const BarrierMesh& patch, const MapIntent& intent, std::size_t enough, UvMap& uv) {
  const BarrierMesh mesh = fit_targets(patch, uv);
  Newton newton(mesh, intent.executor);
  // Without a rim the patch is kept near its map by the method's own energy. Otherwise it takes
  // several times as many steps to return to it.
  Barrier barrier{arap::Rigidity{0.0}, 1};
  if (!has_rim(mesh)) barrier = {intent.rigidity, kWholeWall};
  const std::size_t first = measure::flipped_faces(mesh.faces, uv, mesh.stop).size();
  std::size_t target = mesh.faces.size(), last = target;
  double floor = kFirstEpsilon;
  for (int k = 0; k < kMostTurning; ++k, floor = std::max(kLeastEpsilon, floor / 2)) {
    const std::size_t flips = measure::flipped_faces(mesh.faces, uv, mesh.stop).size();
    const double worst = least_determinant(mesh, uv);
    const bool is_slow = flips > std::exchange(last, flips) / 2;
    if (flips <= enough && (flips > 0 ? is_slow : worst > 0)) return;
    if (k > 0 && k % kPatience == 0 && flips > std::exchange(target, flips / 2)) return;
    if (k == kPatience && mesh.faces.size() > kLargePatch && flips >= first) return;
    throw_if_cancelled(intent.stop);
    barrier.epsilon = std::max(floor, -kEpsilonShare * worst);
    if (newton.step(uv, barrier) < kStuck && barrier.epsilon == kLeastEpsilon) return;
  }
}

}  // namespace unwrapd::solve::repair
