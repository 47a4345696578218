// The wall of the regularised barrier leads away from maps that have just been turned over; the
// symmetric Dirichlet energy takes its place for the last steps: it grows with the square of a
// needle's condition, so that a thousandth of it keeps needles away and hardly moves the others.
#include "core/solve/repair/settle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/cancel.hpp"
#include "core/solve/base/parallel_map.hpp"
#include "core/solve/repair/newton.hpp"
#include "core/solve/repair/sizes.hpp"

namespace unwrapd::solve::repair {
namespace {

/// One stage of the fading barrier; only the last one's minimum counts.
struct FadingStage {
  double wall, dirichlet;  ///< weights, see Barrier
  double tolerance;        ///< relative fall of the energy in one step
};
constexpr double kFloor = 1e-3;  // of the symmetric Dirichlet energy
constexpr std::array kFading{FadingStage{1e-1, 0, 1e-2}, FadingStage{0, 1e-2, 1e-3},
                             FadingStage{0, kFloor, 1e-4}};
constexpr int kMostFading = 20;       // Newton steps for each weight
constexpr int kMostFadingWhole = 60;  // for a whole disk, where the way may be long
constexpr int kMostFadingLarge =
    15;  // for a whole disk beyond kLarge faces, where a step takes seconds
constexpr std::size_t kLarge = 200'000;
constexpr double kWhole =
    5;  // factor of the tolerance for a whole disk: a step costs ten iterations of the solve

constexpr int kNeedleRings = 2;  // around a needle
constexpr double kRaise = 4;     // of the floor, from one round to the next
constexpr int kMostRaises = 4;

/// Sets targets to the sizes in the map, for energies that do not depend on size: the mean stretch
/// of the triangles around each is kept.
void follow_sizes(const UvMap& own, BarrierMesh& mesh) {
  const std::vector<double> size = sizes_around(mesh.faces, mesh.rest, own);
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) mesh.rest[t] = scaled(mesh.rest[t], size[t]);
}

/// The soft constraints at vertices of the patch, by its own numbers.
std::vector<SoftConstraint> soft_constraints_at(const Patch& patch,
                                                const std::vector<SoftConstraint>& soft) {
  std::vector<SoftConstraint> own;
  if (soft.empty()) return own;
  std::map<Index, Index> number;
  for (std::size_t v = 0; v < patch.vertex.size(); ++v)
    number[patch.vertex[v]] = static_cast<Index>(v);
  for (const SoftConstraint& soft_constraint : soft)
    if (const auto at = number.find(soft_constraint.vertex); at != number.end())
      own.push_back({at->second, soft_constraint.at, soft_constraint.weight});
  return own;
}

int most_steps(const Patch& patch, bool is_whole) {
  if (!is_whole) return kMostFading;
  return patch.face.size() > kLarge ? kMostFadingLarge : kMostFadingWhole;
}

/// Lowers the energy of a map without flips, and keeps it free of flips.
void descend(const Disk& disk, const MapIntent& intent, std::span<const FadingStage> fadings,
             Patch& patch, UvMap& own) {
  const bool is_whole = patch.face.size() == disk.faces.size();
  if (intent.rigidity.lambda < kConformalBelow) follow_sizes(own, patch.mesh);
  patch.mesh.soft = soft_constraints_at(patch, intent.soft);
  Newton newton(patch.mesh, intent.executor);
  for (const FadingStage& fading : fadings) {
    const double tolerance = is_whole ? kWhole * fading.tolerance : fading.tolerance;
    const Barrier barrier{intent.rigidity, fading.wall, 0, fading.dirichlet};
    for (int k = 0; k < most_steps(patch, is_whole); ++k) {
      throw_if_cancelled(intent.stop);
      if (newton.step(own, barrier) < tolerance) break;
    }
    if (intent.in_place) break;
  }
}

void descend_all(const Disk& disk, const MapIntent& intent, std::span<const FadingStage> fadings,
                 std::span<Patch> patches, UvMap& uv) {
  const MapIntent own_intent = intent_of_one(intent, patches.size());
  SerialExecutor serial;
  Executor& executor = intent.executor != nullptr ? *intent.executor : serial;
  const auto maps = parallel_map<UvMap>(patches.size(), executor, [&](std::size_t k) {
    UvMap own = map_of(patches[k], uv);
    descend(disk, own_intent, fadings, patches[k], own);
    return own;
  });
  for (std::size_t k = 0; k < patches.size(); ++k) put_back(patches[k], maps[k], uv);
}

std::vector<Index> needles(const Disk& disk, std::span<const char> is_candidate, const UvMap& uv) {
  std::vector<Index> found;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    if (is_candidate[t] == 0) continue;
    const measure::Jacobian j =
        measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
    if (j.sigma_max() > kMostCondition * j.sigma_min()) found.push_back(static_cast<Index>(t));
  }
  return found;
}

}  // namespace

void settle(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& own) {
  descend(disk, intent, kFading, patch, own);
}

void settle_all(const Disk& disk, const MapIntent& intent, std::span<Patch> patches, UvMap& uv) {
  descend_all(disk, intent, kFading, patches, uv);
}

void widen_needles(const Disk& disk, const MapIntent& intent, std::span<const char> is_candidate,
                   UvMap& uv) {
  FadingStage fading = kFading.back();
  for (int k = 0; k < kMostRaises; ++k) {
    const std::vector<Index> found = needles(disk, is_candidate, uv);
    if (found.empty()) return;
    fading.dirichlet *= kRaise;
    std::vector<Patch> patches = patches_around(disk, found, kNeedleRings, intent.constrained);
    descend_all(disk, intent, {&fading, 1}, patches, uv);
  }
}

}  // namespace unwrapd::solve::repair
