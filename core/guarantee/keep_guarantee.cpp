// A map is first repaired in place: flips are untangled, or the virtual boundary of Sec. 4.4 is
// used. Sheets that lie on each other are pressed apart, or the chart gets a new map with a barrier
// between its boundaries. Where that costs too much energy, or fails, the chart is split by a short
// seam between the sheets; its parts keep their share of the map, so that the only cost is the
// seam. A part without the guarantee is treated in the same way. The splitting ends because a
// single triangle has every guarantee.
#include "core/guarantee/keep_guarantee.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/shortest_seam.hpp"
#include "core/charts/split_chart.hpp"
#include "core/guarantee/overlapping_sheets.hpp"
#include "core/guarantee/quantize_uvs.hpp"
#include "core/guarantee/separate_rounded_boundaries.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/repair/bijective.hpp"
#include "core/solve/repair/press_apart.hpp"
#include "core/solve/repair/virtual_patches.hpp"

namespace unwrapd::guarantee {
namespace {

constexpr std::size_t kMostParts = 8;  // of a chart, before it has a new map instead
constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr Index kMostFacesUnfolded = 50'000;  // a new map of more takes minutes

bool holds_any(const solve::repair::MapIntent& intent) {
  return std::any_of(intent.constrained.begin(), intent.constrained.end(),
                     [](char h) { return h != 0; });
}

/// Whether the caller asked for places. Such a chart stays whole, since parts are packed anywhere.
bool has_a_place(const solve::repair::MapIntent& intent) {
  return holds_any(intent) || !intent.soft.empty();
}

/// Removes flips from the map of one disk; returns how many are left.
Index remove_flips(const solve::Disk& disk, const GuaranteeRules& rules, UvMap& uv,
                   Mending& mending) {
  mending.virtual_boundary = rules.repair == RepairMethod::virtual_boundary &&
                             solve::repair::mend_by_virtual_boundary(disk, rules.intent, uv);
  return solve::repair::untangle(disk, rules.intent, uv);
}

/// Two disjoint sets of faces, none of them empty, that a split separates.
using Seeds = std::array<std::vector<Index>, 2>;

/// A flipped face, and the face farthest from it.
Seeds seeds_at_flips(const charts::Chart& chart, const std::vector<Index>& flipped) {
  const Index a = flipped.front();
  Index farthest = a == 0 ? 1 : 0;
  const auto middle = [&](Index t) { return chart.mesh.positions[chart.mesh.faces[t][0]]; };
  for (Index t = 0; t < chart.mesh.face_count(); ++t)
    if (t != a && (middle(t) - middle(a)).norm() > (middle(farthest) - middle(a)).norm())
      farthest = t;
  return {std::vector{a}, std::vector{farthest}};
}

std::vector<std::array<Index, 2>> overlaps_of(const charts::Chart& chart, const UvMap& uv,
                                              const std::stop_token& stop) {
  if (measure::is_plainly_injective(chart.mesh.faces, chart.loops, uv, stop)) return {};
  throw_if_cancelled(stop);
  return measure::overlapping_pairs(chart.mesh.faces, chart.loops, uv, measure::kMostPairs, stop);
}

[[noreturn]] void fail(const std::string& why, const solve::repair::MapIntent& intent) {
  const std::string what_to_do = has_a_place(intent)
                                     ? "relax the constraints"
                                     : "send the smallest parts as a mesh of their own";
  throw Error(ErrorCode::guarantee_failed,
              why + "; " + what_to_do + ", or use guarantee=none to get the raw map", "/guarantee");
}

/// Appends the pieces of a part to `open`.
void append(const GuaranteedPart& part, std::vector<charts::ChartPart> pieces,
            const std::stop_token& stop, std::vector<GuaranteedPart>& open) {
  for (charts::ChartPart& piece : pieces) {
    throw_if_cancelled(stop);
    UvMap uv;
    for (Index v : piece.vertex) uv.push_back(part.uv[v]);
    open.push_back({std::make_shared<const charts::Chart>(std::move(piece.chart)), std::move(uv)});
  }
}

/// What a part needs that has no guarantee: faces that must be in different pieces.
struct Split {
  Seeds seeds;
  bool is_by_shortest_seam = false;
};

/// Splits a part in two or more and appends these to `open`.
void split(const GuaranteedPart& part, const Split& how, const std::stop_token& stop,
           std::vector<GuaranteedPart>& open) {
  throw_if_cancelled(stop);
  const charts::Chart& chart = *part.chart;
  append(part,
         how.is_by_shortest_seam
             ? charts::parts_of(chart, charts::cut_between(chart, how.seeds, stop), stop)
             : charts::split_chart(chart, how.seeds, stop),
         stop, open);
}

/// Whether the map may give way to itself as it is: only ARAP's and Hybrid's energy can.
bool can_press(const GuaranteeRules& rules) {
  return rules.intent.own == solve::repair::OwnEnergy::fit && rules.intent.soft.empty() &&
         !rules.is_pressed;
}

/// Presses sheets of the part apart that lie on each other; false, with the part as it was, if they
/// do not part at little cost.
bool press(GuaranteedPart& part, double unit, const GuaranteeRules& rules, Mending& mending) {
  const solve::repair::MapIntent& intent = rules.intent;
  const solve::Disk disk = solve::make_disk(part.chart->mesh, part.chart->loops, intent.stop);
  UvMap before = part.uv;
  for (Vec2& u : before) u *= unit / disk.unit;
  UvMap uv = before;
  if (!solve::repair::press_apart(disk, intent, std::min(rules.most_rise, kMostPressed), uv))
    return false;
  const double rise = energy_rise(disk, rules, before, uv);
  for (Vec2& u : uv) u *= disk.unit / unit;
  if (!overlaps_of(*part.chart, uv, intent.stop).empty()) return false;
  mending.energy_rise = std::max(mending.energy_rise, rise);
  part.uv = std::move(uv);
  return true;
}

/// Gives the part a map without overlaps that follows the soft constraints; unit: of the part's
/// map, in units of the mesh. The part stays as it is, and the answer is false, where no such map
/// is found or its energy is too high.
bool unfold(GuaranteedPart& part, double unit, const GuaranteeRules& rules) {
  const solve::repair::MapIntent& intent = rules.intent;
  const solve::Disk disk = solve::make_disk(part.chart->mesh, part.chart->loops, intent.stop);
  UvMap uv = part.uv;
  if (!solve::repair::map_injectively(disk, intent, uv, part.chart->start)) return false;
  const bool is_bounded = rules.most_rise < kUnbounded;
  UvMap before = is_bounded ? part.uv : UvMap();
  for (Vec2& u : before) u *= unit / disk.unit;
  if (is_bounded && rises_too_far(disk, rules, uv, before)) return false;
  for (Vec2& u : uv) u *= disk.unit / unit;
  if (!overlaps_of(*part.chart, uv, intent.stop).empty()) return false;
  part.uv = std::move(uv);
  return true;
}

/// Parts the sheets of a part that lie on each other, in its map or in a new one.
bool lay_apart(GuaranteedPart& part, double unit, const GuaranteeRules& rules, Mending& mending) {
  if (holds_any(rules.intent)) return false;
  if (can_press(rules) && press(part, unit, rules, mending)) return true;
  const bool is_small = part.chart->mesh.face_count() <= kMostFacesUnfolded;
  return is_small && rules.most_rise > kMostPressed && unfold(part, unit, rules);
}

/// The split that a part with these flips needs; none where it has the guarantee, perhaps after its
/// map has changed.
std::optional<Split> split_needed(GuaranteedPart& part, const std::vector<Index>& flipped,
                                  double unit, const GuaranteeRules& rules, Mending& mending) {
  if (!flipped.empty()) {
    if (part.chart->mesh.face_count() == 1) fail("a triangle has no area in the map", rules.intent);
    return Split{seeds_at_flips(*part.chart, flipped)};
  }
  if (rules.guarantee != Guarantee::bijective) return {};
  const auto pairs = overlaps_of(*part.chart, part.uv, rules.intent.stop);
  if (pairs.empty()) return {};
  mending.overlaps += static_cast<Index>(pairs.size());
  if (lay_apart(part, unit, rules, mending)) return {};
  return Split{overlapping_sheets(*part.chart, pairs), true};
}

/// The flips of a part of a split chart, after another try to untangle them: a part may succeed
/// where the whole chart failed.
std::vector<Index> flips_left(GuaranteedPart& part, const solve::repair::MapIntent& intent) {
  std::vector<Index> flipped = measure::flipped_faces(part.chart->mesh.faces, part.uv, intent.stop);
  if (flipped.empty()) return flipped;
  const solve::Disk disk = solve::make_disk(part.chart->mesh, part.chart->loops, intent.stop);
  solve::repair::untangle(disk,
                          {.rigidity = intent.rigidity,
                           .constrained = {},
                           .stop = intent.stop,
                           .executor = intent.executor},
                          part.uv);
  return measure::flipped_faces(part.chart->mesh.faces, part.uv);
}

/// Splits until every part has the guarantee; empty if that takes more than `most` parts. flipped:
/// the flipped faces of the whole.
std::vector<GuaranteedPart> split_as_needed(GuaranteedPart whole, std::vector<Index> flipped,
                                            double unit, const GuaranteeRules& rules,
                                            std::size_t most, Mending& mending) {
  std::vector<GuaranteedPart> open, kept;
  GuaranteeRules of_part = rules;
  of_part.intent.global = nullptr;
  of_part.is_pressed = false;
  open.push_back(std::move(whole));
  for (bool is_whole = true; !open.empty(); is_whole = false) {
    GuaranteedPart part = std::move(open.back());
    open.pop_back();
    throw_if_cancelled(rules.intent.stop);
    if (open.size() + kept.size() >= most) return {};
    if (!is_whole) flipped = flips_left(part, rules.intent);
    const std::optional<Split> needed =
        split_needed(part, flipped, unit, is_whole ? rules : of_part, mending);
    if (!needed)
      kept.push_back(std::move(part));
    else if (has_a_place(rules.intent))
      fail("no map without flips or overlaps was found for the constraints", rules.intent);
    else
      split(part, *needed, rules.intent.stop, open);
  }
  return kept;
}

/// The same for any number of parts. A map that takes more than a few cuts is tangled all over: a
/// new one is then better, whatever its energy.
std::vector<GuaranteedPart> with_guarantee(GuaranteedPart whole, std::vector<Index> flipped,
                                           double unit, GuaranteeRules rules, Mending& mending) {
  constexpr auto kAny = std::numeric_limits<std::size_t>::max();
  if (whole.chart->least != Guarantee::bijective && rules.most_rise < kUnbounded) {
    Mending own = mending;
    std::vector<GuaranteedPart> parts =
        split_as_needed(whole, flipped, unit, rules, kMostParts, own);
    if (!parts.empty()) {
      mending = own;
      return parts;
    }
    rules.is_pressed = rules.most_rise >= kMostPressed;
    rules.most_rise = kUnbounded;
  }
  return split_as_needed(std::move(whole), std::move(flipped), unit, rules, kAny, mending);
}

}  // namespace

GuaranteedMap keep_guarantee(std::shared_ptr<const charts::Chart> chart, const solve::Disk& disk,
                             UvMap uv, const GuaranteeRules& rules) {
  GuaranteedMap kept;
  if (rules.guarantee == Guarantee::none) {
    kept.parts.push_back({std::move(chart), std::move(uv)});
    return kept;
  }
  throw_if_cancelled(rules.intent.stop);
  std::vector<Index> flipped = measure::flipped_faces(disk.faces, uv, rules.intent.stop);
  kept.mending.flips = static_cast<Index>(flipped.size());
  const bool may_change = kept.mending.flips > 0 || rules.guarantee == Guarantee::bijective;
  const UvMap before = may_change ? uv : UvMap();
  const auto rise = [&](const UvMap& now) { return energy_rise(disk, rules, before, now); };
  if (!flipped.empty()) {
    if (remove_flips(disk, rules, uv, kept.mending) == 0) kept.mending.energy_rise = rise(uv);
    flipped = measure::flipped_faces(disk.faces, uv);
  }
  kept.parts = with_guarantee({std::move(chart), std::move(uv)}, std::move(flipped), disk.unit,
                              rules, kept.mending);
  throw_if_cancelled(rules.intent.stop);
  if (kept.mending.overlaps > 0 && kept.parts.size() == 1)
    kept.mending.energy_rise = rise(kept.parts.front().uv);
  kept.mending.parts = static_cast<Index>(kept.parts.size());
  return kept;
}

Written keep_on_page(const charts::Chart& chart, const GuaranteeRules& rules, UvMap& page_uv) {
  if (rules.guarantee == Guarantee::none) {
    round_to_step(page_uv, rules.intent.constrained);
    return {static_cast<Index>(measure::flipped_faces(chart.mesh.faces, page_uv).size()), {}};
  }
  if (quantize_uvs(chart, rules.intent.constrained, rules.intent.stop, page_uv) > 0)
    fail(
        "a triangle is too small, compared with the page, for the precision in which UVs are "
        "written",
        rules.intent);
  const auto overlaps = static_cast<Index>(overlaps_of(chart, page_uv, rules.intent.stop).size());
  if (overlaps == 0 || rules.guarantee != Guarantee::bijective) return {0, overlaps};
  if (!separate_rounded_boundaries(chart, rules.intent.constrained, page_uv, rules.intent.stop))
    fail("two triangles are too close to each other for the precision in which UVs are written",
         rules.intent);
  return {0, 0};
}

}  // namespace unwrapd::guarantee
