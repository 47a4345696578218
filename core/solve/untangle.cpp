// Around the flips, everything within a few rings of triangles is let loose; the rest of the map
// holds the rim. First the regularised barrier turns the triangles over (its epsilon shrinks with
// the worst of them); then the method's own energy is minimised under a barrier that fades. Where
// that fails the patch grows, in the end to the whole chart, which at last starts anew from Tutte's
// map. Where flips are many, patches hold each other's folds fast: there the whole comes first, at
// many times the cost.
#include "core/solve/untangle.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/cancel.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/convex_map.hpp"
#include "core/solve/fill_holes.hpp"
#include "core/solve/hold_align.hpp"
#include "core/solve/newton.hpp"
#include "core/solve/patch.hpp"
#include "core/solve/virtual_boundary.hpp"

namespace unwrapd {
namespace {

constexpr int kMostRings = 64;
constexpr int kMostRounds = 4;         // from small patches to large ones
constexpr int kMostTurning = 90;       // Newton steps under the regularised barrier
constexpr int kPatience = 15;          // steps in which the flips must halve, after the first ones
constexpr double kCrowded = 0.25;      // share of flips beyond which only the whole is worth a try
constexpr double kMany = 0.05;         // share of flips beyond which the whole comes first
constexpr double kFew = 0.02;          // of those flips, to be left to patches
constexpr int kSettlingRings = 2;      // around what is rough
constexpr double kEpsilonShare = 0.2;  // of the worst determinant
constexpr double kFirstEpsilon = 0.1;  // collapsed triangles open under a large one
constexpr double kLeastEpsilon = 1e-6;
constexpr double kStuck = 1e-5;       // relative fall of the energy in one step
constexpr int kMostFading = 20;       // Newton steps for each weight
constexpr int kMostFadingWhole = 60;  // where the way may be long
constexpr double kWhole = 3;          // tolerances then: a step costs ten iterations of the solve
/// How the barrier fades; only its last minimum counts.
struct Fading {
  double weight;
  double tolerance;  ///< relative fall of the energy in one step
};
constexpr std::array kFading{Fading{1e-1, 1e-2}, Fading{1e-2, 1e-3}, Fading{1e-3, 1e-4}};

constexpr double kConformalBelow = 0.01;  // lambda: below, sizes are not the energy's business
constexpr double kLeastStretch = 1e-12;

bool may_move_all(const MapIntent& intent) {
  return !intent.in_place &&
         std::none_of(intent.held.begin(), intent.held.end(), [](char h) { return h != 0; });
}

bool exceeds(std::size_t count, double share, std::size_t all) {
  return static_cast<double>(count) > share * static_cast<double>(all);
}

void scale(RestTriangle& rest, double by) {
  for (Vec2& e : rest.edge) e *= by;
  rest.area *= by * by;
}

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
    scale(patch.mesh.rest[k], target_scale(disk, patch.face[k], uv));
}

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
    for (RestTriangle& rest : fit.rest) scale(rest, std::sqrt(room / wanted));
  return fit;
}

bool is_untangled(const BarrierMesh& mesh, const UvMap& uv) {
  return least_determinant(mesh, uv) > 0 && flipped_faces(mesh.faces, uv, mesh.stop).empty();
}

/// Turns the triangles of a patch over until at most `enough` are flipped. Gives up where they do
/// not grow fewer.
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

/// From a map without flips to one of little energy without flips.
void fade(const BarrierMesh& mesh, const MapIntent& intent, bool is_whole, UvMap& uv) {
  Newton newton(mesh);
  for (const Fading& fading : kFading) {
    const double tolerance = is_whole ? kWhole * fading.tolerance : fading.tolerance;
    for (int k = 0; k < (is_whole ? kMostFadingWhole : kMostFading); ++k) {
      throw_if_cancelled(intent.stop);
      if (newton.step(uv, {intent.rigidity, fading.weight, 0}) < tolerance) break;
    }
    if (intent.in_place) break;
  }
}

UvMap map_of(const Patch& patch, const UvMap& uv) {
  UvMap own;
  own.reserve(patch.vertex.size());
  for (Index v : patch.vertex) own.push_back(uv[v]);
  return own;
}

void put_back(const Patch& patch, const UvMap& own, UvMap& uv) {
  for (std::size_t v = 0; v < own.size(); ++v) uv[patch.vertex[v]] = own[v];
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

/// Lets a patch without flips find its least energy.
void settle(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& uv) {
  const bool is_whole = patch.face.size() == disk.faces.size();
  if (intent.rigidity.lambda < kConformalBelow) follow_sizes(disk, uv, patch);
  patch.mesh.springs = springs_at(patch, intent.springs);
  UvMap own = map_of(patch, uv);
  fade(patch.mesh, intent, is_whole, own);
  put_back(patch, own, uv);
}

/// What rounds of patches leave.
struct Left {
  std::vector<Index> flipped;
  std::vector<char> is_rough;  ///< of each face: turned over with others, but not settled since

  void mark(const Patch& patch, char rough) {
    for (Index t : patch.face) is_rough[t] = rough;
  }
  [[nodiscard]] std::vector<Index> rough() const {
    std::vector<Index> faces;
    for (std::size_t t = 0; t < is_rough.size(); ++t)
      if (is_rough[t] != 0) faces.push_back(static_cast<Index>(t));
    return faces;
  }
};

/// Mends one patch. Where that fails the map stays as it is, unless half of the flips are gone:
/// then it has yet to settle.
void mend(const Disk& disk, const MapIntent& intent, Patch& patch, UvMap& uv, Left& left) {
  UvMap own = map_of(patch, uv);
  const std::size_t before = flipped_faces(patch.mesh.faces, own, disk.stop).size();
  turn_over(patch.mesh, intent, 0, own);
  const bool is_mended = is_untangled(patch.mesh, own);
  if (!is_mended && flipped_faces(patch.mesh.faces, own, disk.stop).size() > before / 2) return;
  put_back(patch, own, uv);
  if (is_mended) settle(disk, intent, patch, uv);
  left.mark(patch, is_mended ? 0 : 1);
}

Patch whole(const Disk& disk) {
  std::vector<Index> all(disk.faces.size());
  std::iota(all.begin(), all.end(), 0);
  return std::move(patches_around(disk, all, 0, {}).front());
}

/// A new map at the surface's size or, where there are springs, where they draw it.
UvMap at_its_place(const Disk& disk, const MapIntent& intent, UvMap uv) {
  const double area = uv_area(disk.rest, disk.faces, uv);
  for (Vec2& u : uv) u /= std::sqrt(area);
  return intent.springs.empty() ? uv : held_start(std::move(uv), {{}, intent.springs});
}

UvMap tutte_without_holes(const Disk& disk) {
  UvMap uv = tutte_map(fill_holes(disk).disk);
  uv.resize(disk.positions.size());
  return uv;
}

/// Turns over all at once where flips are many, so that few are left; a map that this does not help
/// stays as it is.
void thin_out(const Disk& disk, const MapIntent& intent, UvMap& uv, Left& left) {
  const std::size_t before = left.flipped.size();
  if (!may_move_all(intent) || !exceeds(before, kMany, disk.faces.size())) return;
  Patch patch = whole(disk);
  const auto few = static_cast<std::size_t>(kFew * static_cast<double>(before));
  UvMap own = map_of(patch, uv);
  turn_over(patch.mesh, intent, few, own);
  if (flipped_faces(patch.mesh.faces, own, disk.stop).size() > few) return;
  put_back(patch, own, uv);
  left.flipped = flipped_faces(disk.faces, uv, disk.stop);
  left.mark(patch, 1);
}

/// Whether a patch holds more flips than there is hope for within its rim.
bool is_crowded(const Patch& patch, const UvMap& uv) {
  const std::size_t flips = flipped_faces(patch.mesh.faces, map_of(patch, uv)).size();
  return exceeds(flips, kCrowded, patch.face.size());
}

/// Patches of growing size, in the end the whole.
void mend_patches(const Disk& disk, const MapIntent& intent, UvMap& uv, Left& left) {
  bool was_whole = false;
  for (int rings = intent.rings; !was_whole && !left.flipped.empty(); rings *= 2) {
    for (Patch& patch : patches_around(disk, left.flipped, rings, intent.held)) {
      was_whole = was_whole || patch.face.size() == disk.faces.size();
      const bool may_grow = may_move_all(intent) && !was_whole && rings < kMostRings;
      if (may_grow && is_crowded(patch, uv)) continue;
      mend(disk, intent, patch, uv, left);
    }
    left.flipped = flipped_faces(disk.faces, uv, disk.stop);
    if (rings >= kMostRings) break;
  }
}

/// Rounds of patches as long as each leaves half of the flips at most.
void mend_in_rounds(const Disk& disk, const MapIntent& intent, UvMap& uv, Left& left) {
  for (int round = 0; round < kMostRounds && !left.flipped.empty(); ++round) {
    const std::size_t before = left.flipped.size();
    mend_patches(disk, intent, uv, left);
    if (left.flipped.size() > before / 2) break;
  }
}

/// Other maps, which have no flips to begin with.
bool start_over(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  return may_move_all(intent) && (start_anew(disk, intent, virtual_boundary_map(disk, uv), uv) ||
                                  start_anew(disk, intent, tutte_without_holes(disk), uv));
}

}  // namespace

bool start_anew(const Disk& disk, const MapIntent& intent, UvMap start, UvMap& uv) {
  start = at_its_place(disk, intent, std::move(start));
  if (!flipped_faces(disk.faces, start, disk.stop).empty()) return false;
  uv = std::move(start);
  Patch patch = whole(disk);
  settle(disk, intent, patch, uv);
  return true;
}

Index untangle(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  assert(intent.rings >= 1);
  Left left{flipped_faces(disk.faces, uv, disk.stop), std::vector<char>(disk.faces.size(), 0)};
  thin_out(disk, intent, uv, left);
  if (exceeds(left.flipped.size(), kMany, disk.faces.size()) && start_over(disk, intent, uv))
    return 0;
  mend_in_rounds(disk, intent, uv, left);
  if (!left.flipped.empty())
    return start_over(disk, intent, uv) ? 0 : static_cast<Index>(left.flipped.size());
  for (Patch& patch : patches_around(disk, left.rough(), kSettlingRings, intent.held))
    settle(disk, intent, patch, uv);
  return 0;
}

}  // namespace unwrapd
