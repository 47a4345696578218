// Frees everything within a few rings of the flips; the rest of the map fixes the rim. First the
// regularized barrier turns the triangles over. Then the method's own energy is minimized under a
// barrier that fades, and needles are widened. If that fails the patch grows, in the end to the
// whole chart, which at last starts again from Tutte's map. If flips are many, patches block each
// other's folds: the whole chart is then repaired first, at many times the cost; a large disk by
// steps that need no factor of their own (turn_over_all).
#include "core/solve/repair/untangle.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/base/align_constrained.hpp"
#include "core/solve/base/parallel_map.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/repair/patch.hpp"
#include "core/solve/repair/settle.hpp"
#include "core/solve/repair/turn_over.hpp"
#include "core/solve/repair/turn_over_all.hpp"
#include "core/solve/repair/virtual_boundary.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr int kMostRings = 64;
constexpr int kMostRounds = 4;     // from small patches to large ones
constexpr double kCrowded = 0.25;  // share of flips beyond which only the whole is worth an attempt
constexpr double kMany = 0.05;     // share of flips beyond which the whole comes first
constexpr std::size_t kLargeDisk = 4096;  // faces; below, Newton steps on the whole take little
constexpr double kManyOfLarge = 0.005;    // the same of a large disk, where the whole costs less
constexpr double kFew = 0.02;             // of those flips, which patches may repair
constexpr int kSettlingRings = 2;         // around rough faces
bool may_move_all(const MapIntent& intent) {
  return !intent.in_place && std::none_of(intent.constrained.begin(), intent.constrained.end(),
                                          [](char h) { return h != 0; });
}

bool exceeds(std::size_t count, double share, std::size_t all) {
  return static_cast<double>(count) > share * static_cast<double>(all);
}

/// The state of a face.
enum State : char { kUntouched, kRough, kSettled };  // rough: turned over, but not settled since

/// The result of rounds of patches.
struct RepairState {
  std::vector<Index> flipped;
  std::vector<char> state;           ///< of each face
  bool has_tried_the_whole = false;  ///< a second attempt would fail likewise

  void mark(const Patch& patch, State now) {
    for (Index t : patch.face) state[t] = now;
  }
  [[nodiscard]] std::vector<Index> rough() const {
    std::vector<Index> faces;
    for (std::size_t t = 0; t < state.size(); ++t)
      if (state[t] == kRough) faces.push_back(static_cast<Index>(t));
    return faces;
  }
};

/// A patch after an attempt to repair it. If that fails the map stays as it is, unless half of the
/// flips are gone: then the patch has yet to settle.
struct Attempt {
  UvMap own;
  State state = kUntouched;
};

/// If triangles that were turned over block each other, tries again from an evened-out map. A
/// larger patch would contain the same knot.
void untie(const Patch& patch, const MapIntent& intent, const UvMap& uv, UvMap& own) {
  const bool has_rim = patch.mesh.free.count < static_cast<Index>(own.size());
  if (!has_rim || is_untangled(patch.mesh, own)) return;
  UvMap even = even_out(patch.mesh, map_of(patch, uv));
  turn_over(patch.mesh, intent, 0, even);
  if (is_untangled(patch.mesh, even)) own = std::move(even);
}

Attempt repair_patch(const Disk& disk, const MapIntent& intent, Patch& patch, const UvMap& uv) {
  Attempt attempt{map_of(patch, uv)};
  const std::size_t before =
      measure::flipped_faces(patch.mesh.faces, attempt.own, disk.stop).size();
  turn_over(patch.mesh, intent, 0, attempt.own);
  untie(patch, intent, uv, attempt.own);
  if (is_untangled(patch.mesh, attempt.own)) {
    settle(disk, intent, patch, attempt.own);
    attempt.state = kSettled;
  } else if (measure::flipped_faces(patch.mesh.faces, attempt.own, disk.stop).size() <=
             before / 2) {
    attempt.state = kRough;
  }
  return attempt;
}

/// Repairs patches that share no triangle, in parallel.
void mend_all(const Disk& disk, const MapIntent& intent, std::span<Patch> patches, UvMap& uv,
              RepairState& left) {
  const MapIntent own_intent = intent_of_one(intent, patches.size());
  SerialExecutor serial;
  Executor& executor = intent.executor != nullptr ? *intent.executor : serial;
  const auto attempts = parallel_map<Attempt>(patches.size(), executor, [&](std::size_t k) {
    return repair_patch(disk, own_intent, patches[k], uv);
  });
  for (std::size_t k = 0; k < patches.size(); ++k) {
    if (attempts[k].state == kUntouched) continue;
    put_back(patches[k], attempts[k].own, uv);
    left.mark(patches[k], attempts[k].state);
  }
}

Patch whole(const Disk& disk) {
  std::vector<Index> all(disk.faces.size());
  std::iota(all.begin(), all.end(), 0);
  return std::move(patches_around(disk, all, 0, {}).front());
}

/// Places a new map at the surface's size or, if there are soft constraints, by them.
UvMap at_its_place(const Disk& disk, const MapIntent& intent, UvMap uv) {
  uv = with_unit_area(disk, std::move(uv));
  return intent.soft.empty() ? uv : constrained_start(std::move(uv), {{}, intent.soft});
}

UvMap tutte_without_holes(const Disk& disk) {
  UvMap uv = maps::tutte_map(maps::fill_holes(disk).disk);
  uv.resize(disk.positions.size());
  return uv;
}

/// Turns over a large disk as a whole if flips are many. Newton steps on the whole would take
/// several times as long as its solve, and four times the memory. Returns false, with uv as it was,
/// if many flips are left.
bool thin_out_large(const Disk& disk, const MapIntent& intent, UvMap& uv, RepairState& left) {
  const std::size_t before = left.flipped.size(), all = disk.faces.size();
  if (intent.in_place || all <= kLargeDisk || !exceeds(before, kManyOfLarge, all)) return false;
  UvMap own = uv;
  turn_over_all(disk, intent, own);
  std::vector<Index> flipped = measure::flipped_faces(disk.faces, own, disk.stop);
  if (exceeds(flipped.size(), kFew, before) && exceeds(flipped.size(), kFew * kMany, all))
    return false;
  uv = std::move(own);
  left.flipped = std::move(flipped);
  return true;
}

/// The same for any disk. A map that is not improved stays as it is.
void thin_out(const Disk& disk, const MapIntent& intent, UvMap& uv, RepairState& left) {
  if (thin_out_large(disk, intent, uv, left)) return;
  const std::size_t before = left.flipped.size();
  if (!may_move_all(intent) || !exceeds(before, kMany, disk.faces.size())) return;
  Patch patch = whole(disk);
  const auto few = static_cast<std::size_t>(kFew * static_cast<double>(before));
  UvMap own = map_of(patch, uv);
  turn_over(patch.mesh, intent, few, own);
  if (measure::flipped_faces(patch.mesh.faces, own, disk.stop).size() > few) return;
  put_back(patch, own, uv);
  left.flipped = measure::flipped_faces(disk.faces, uv, disk.stop);
  left.mark(patch, kRough);
}

/// Whether a patch has too many flips to be repaired within its rim.
bool is_crowded(const Patch& patch, const UvMap& uv) {
  const std::size_t flips = measure::flipped_faces(patch.mesh.faces, map_of(patch, uv)).size();
  return exceeds(flips, kCrowded, patch.face.size());
}

/// Repairs patches of growing size, in the end the whole.
void mend_patches(const Disk& disk, const MapIntent& intent, UvMap& uv, RepairState& left) {
  bool was_whole = false;
  for (int rings = intent.rings; !was_whole && !left.flipped.empty(); rings *= 2) {
    std::vector<Patch> patches = patches_around(disk, left.flipped, rings, intent.constrained);
    was_whole = patches.size() == 1 && patches[0].face.size() == disk.faces.size();
    if (was_whole && std::exchange(left.has_tried_the_whole, true)) return;
    if (may_move_all(intent) && !was_whole && rings < kMostRings)
      std::erase_if(patches, [&](const Patch& patch) { return is_crowded(patch, uv); });
    mend_all(disk, intent, patches, uv, left);
    left.flipped = measure::flipped_faces(disk.faces, uv, disk.stop);
    if (rings >= kMostRings) break;
  }
}

/// Repeats rounds of patches as long as each leaves at most half of the flips.
void mend_in_rounds(const Disk& disk, const MapIntent& intent, UvMap& uv, RepairState& left) {
  for (int round = 0; round < kMostRounds && !left.flipped.empty(); ++round) {
    const std::size_t before = left.flipped.size();
    mend_patches(disk, intent, uv, left);
    if (left.flipped.size() > before / 2) break;
  }
}

/// Starts again from maps that have no flips.
bool start_over(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  return may_move_all(intent) && (start_anew(disk, intent, virtual_boundary_map(disk, uv), uv) ||
                                  start_anew(disk, intent, tutte_without_holes(disk), uv));
}

}  // namespace

bool start_anew(const Disk& disk, const MapIntent& intent, UvMap start, UvMap& uv) {
  start = at_its_place(disk, intent, std::move(start));
  if (!measure::flipped_faces(disk.faces, start, disk.stop).empty()) return false;
  uv = std::move(start);
  Patch patch = whole(disk);
  settle_all(disk, intent, {&patch, 1}, uv);
  widen_needles(disk, intent, std::vector<char>(disk.faces.size(), 1), uv);
  return true;
}

Index untangle(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  assert(intent.rings >= 1);
  RepairState left{measure::flipped_faces(disk.faces, uv, disk.stop),
                   std::vector<char>(disk.faces.size(), kUntouched)};
  thin_out(disk, intent, uv, left);
  if (exceeds(left.flipped.size(), kMany, disk.faces.size()) && start_over(disk, intent, uv))
    return 0;
  mend_in_rounds(disk, intent, uv, left);
  if (!left.flipped.empty())
    return start_over(disk, intent, uv) ? 0 : static_cast<Index>(left.flipped.size());
  std::vector<Patch> rough = patches_around(disk, left.rough(), kSettlingRings, intent.constrained);
  settle_all(disk, intent, rough, uv);
  for (const Patch& patch : rough) left.mark(patch, kSettled);
  if (!intent.in_place) widen_needles(disk, intent, left.state, uv);
  return 0;
}

}  // namespace unwrapd::solve::repair
