// The wall of the regularised barrier leads away from maps that have just been turned over; the
// symmetric Dirichlet energy takes its place for the last steps: it grows with the square of a
// needle's condition, so that a thousandth of it keeps needles away and hardly moves the others.
#include "core/solve/settle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/cancel.hpp"
#include "core/solve/newton.hpp"

namespace unwrapd {
namespace {

/// How the barrier fades; only its last minimum counts.
struct Fading {
  double wall, dirichlet;  ///< weights, see Barrier
  double tolerance;        ///< relative fall of the energy in one step
};
constexpr double kFloor = 1e-3;  // of the symmetric Dirichlet energy
constexpr std::array kFading{Fading{1e-1, 0, 1e-2}, Fading{0, 1e-2, 1e-3}, Fading{0, kFloor, 1e-4}};
constexpr int kMostFading = 20;       // Newton steps for each weight
constexpr int kMostFadingWhole = 60;  // where the way may be long
constexpr double kWhole = 3;          // tolerances then: a step costs ten iterations of the solve

constexpr int kNeedleRings = 2;  // around a needle
constexpr double kRaise = 4;     // of the floor, from one round to the next
constexpr int kMostRaises = 4;

constexpr double kConformalBelow = 0.01;  // lambda: below, sizes are not the energy's business
constexpr double kLeastStretch = 1e-12;

/// The factor by which each rest triangle is taken larger or smaller. Angles alone say nothing
/// about size: there the neighbours' mean stretch is kept.
double target_scale(const Disk& disk, Index face, const UvMap& uv) {
  double sum = 0;
  int count = 0;
  for (Index v : disk.faces[face])
    for (Index c = disk.corners.begin[v]; c < disk.corners.begin[v + 1]; ++c) {
      const Index t = disk.corners.corner[c] / 3;
      const Jacobian j = jacobian(disk.rest[t], uv_edges(disk.faces[t], uv));
      sum += std::log(std::max(kLeastStretch, std::hypot(j.turn_scale(), j.deformation())));
      ++count;
    }
  return std::exp(sum / count);
}

/// Targets of the size that the map has there, for energies that do not care about size.
void follow_sizes(const Disk& disk, const UvMap& uv, Patch& patch) {
  for (std::size_t k = 0; k < patch.face.size(); ++k)
    patch.mesh.rest[k] = scaled(patch.mesh.rest[k], target_scale(disk, patch.face[k], uv));
}

/// The springs at vertices of the patch, by its own numbers.
std::vector<Spring> springs_at(const Patch& patch, const std::vector<Spring>& springs) {
  std::vector<Spring> own;
  if (springs.empty()) return own;
  std::map<Index, Index> number;
  for (std::size_t v = 0; v < patch.vertex.size(); ++v)
    number[patch.vertex[v]] = static_cast<Index>(v);
  for (const Spring& spring : springs)
    if (const auto at = number.find(spring.vertex); at != number.end())
      own.push_back({at->second, spring.at, spring.weight});
  return own;
}

/// From a map without flips to one of little energy without flips.
void descend(const Disk& disk, const MapIntent& intent, std::span<const Fading> fadings,
             Patch& patch, UvMap& uv) {
  const bool is_whole = patch.face.size() == disk.faces.size();
  if (intent.rigidity.lambda < kConformalBelow) follow_sizes(disk, uv, patch);
  patch.mesh.springs = springs_at(patch, intent.springs);
  UvMap own = map_of(patch, uv);
  Newton newton(patch.mesh);
  for (const Fading& fading : fadings) {
    const double tolerance = is_whole ? kWhole * fading.tolerance : fading.tolerance;
    const Barrier barrier{intent.rigidity, fading.wall, 0, fading.dirichlet};
    for (int k = 0; k < (is_whole ? kMostFadingWhole : kMostFading); ++k) {
      throw_if_cancelled(intent.stop);
      if (newton.step(own, barrier) < tolerance) break;
    }
    if (intent.in_place) break;
  }
  put_back(patch, own, uv);
}

std::vector<Index> needles(const Disk& disk, std::span<const char> is_candidate, const UvMap& uv) {
  std::vector<Index> found;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    look_now_and_then(t, disk.stop);
    if (is_candidate[t] == 0) continue;
    const Jacobian j = jacobian(disk.rest[t], uv_edges(disk.faces[t], uv));
    if (j.sigma_max() > kMostCondition * j.sigma_min()) found.push_back(static_cast<Index>(t));
  }
  return found;
}

}  // namespace

void settle(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& uv) {
  descend(disk, intent, kFading, patch, uv);
}

void widen_needles(const Disk& disk, const MapIntent& intent, std::span<const char> is_candidate,
                   UvMap& uv) {
  Fading fading = kFading.back();
  for (int k = 0; k < kMostRaises; ++k) {
    const std::vector<Index> found = needles(disk, is_candidate, uv);
    if (found.empty()) return;
    fading.dirichlet *= kRaise;
    for (Patch& patch : patches_around(disk, found, kNeedleRings, intent.held))
      descend(disk, intent, {&fading, 1}, patch, uv);
  }
}

}  // namespace unwrapd
