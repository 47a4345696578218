// A map is first repaired in place: flips are untangled, or the virtual boundary of Sec. 4.4 is
// used. A chart that overlaps itself gets a new map with a barrier between its boundaries. If
// neither helps, the chart is split; its parts keep their share of the map, so that the only cost
// is the seam. A part without the guarantee is treated in the same way. The splitting ends because
// a single triangle has every guarantee.
#include "core/guarantee/keep_guarantee.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/split_chart.hpp"
#include "core/guarantee/quantize_uvs.hpp"
#include "core/guarantee/separate_rounded_boundaries.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/repair/bijective.hpp"
#include "core/solve/repair/virtual_patches.hpp"

namespace unwrapd::guarantee {
namespace {

constexpr std::size_t kMostPairs = 1 << 20;   // of overlapping triangles, counted in one chart
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

/// The connected components into which a set of faces and what is outside of it fall: one number a
/// face.
std::vector<Index> component_numbers(const charts::Chart& chart, const std::vector<char>& in_set) {
  Halfedges cut = chart.halfedges;
  for (std::size_t h = 0; h < cut.twin.size(); ++h)
    if (cut.twin[h] != kNoTwin && in_set[cut.twin[h] / 3] != in_set[h / 3]) cut.twin[h] = kNoTwin;
  return topology(corner_vertices(cut).faces, cut).component_of;
}

/// The two whole regions of the first overlap where they are not connected, else its two faces.
Seeds seeds_at_overlaps(const charts::Chart& chart,
                        const std::vector<std::array<Index, 2>>& pairs) {
  std::vector<char> in_set(chart.mesh.faces.size(), 0);
  for (const auto& [s, t] : pairs) in_set[s] = in_set[t] = 1;
  const std::vector<Index> number = component_numbers(chart, in_set);
  const auto apart = std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return number[pair[0]] != number[pair[1]];
  });
  if (apart == pairs.end()) return {std::vector{pairs[0][0]}, std::vector{pairs[0][1]}};
  Seeds seeds;
  for (std::size_t k : {0U, 1U})
    for (std::size_t t = 0; t < number.size(); ++t)
      if (number[t] == number[(*apart)[k]]) seeds[k].push_back(static_cast<Index>(t));
  return seeds;
}

std::vector<std::array<Index, 2>> overlaps_of(const charts::Chart& chart, const UvMap& uv,
                                              const std::stop_token& stop) {
  if (measure::is_plainly_injective(chart.mesh.faces, chart.loops, uv, stop)) return {};
  throw_if_cancelled(stop);
  return measure::overlapping_pairs(chart.mesh.faces, chart.loops, uv, kMostPairs, stop);
}

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorCode::guarantee_failed,
              why + "; relax the constraints, or use guarantee=none to get the raw map",
              "/guarantee");
}

/// Splits a part in two or more and appends these to `open`.
void split(const GuaranteedPart& part, const Seeds& seeds, const std::stop_token& stop,
           std::vector<GuaranteedPart>& open) {
  throw_if_cancelled(stop);
  for (charts::ChartPart& piece : charts::split_chart(*part.chart, seeds, stop)) {
    throw_if_cancelled(stop);
    UvMap uv;
    for (Index v : piece.vertex) uv.push_back(part.uv[v]);
    open.push_back({std::make_shared<const charts::Chart>(std::move(piece.chart)), std::move(uv)});
  }
}

/// Gives the part a map without overlaps that follows the soft constraints; unit: of the part's
/// map, in units of the mesh. The part stays as it is, and the answer is false, where no such map
/// is found or its energy is too high.
bool unfold(GuaranteedPart& part, double unit, const GuaranteeRules& rules) {
  const solve::repair::MapIntent& intent = rules.intent;
  const solve::Disk disk = solve::make_disk(part.chart->mesh, part.chart->loops, intent.stop);
  UvMap uv = part.uv;
  if (!solve::repair::map_injectively(disk, intent, uv)) return false;
  const bool is_bounded = rules.most_rise < std::numeric_limits<double>::infinity();
  UvMap before = is_bounded ? part.uv : UvMap();
  for (Vec2& u : before) u *= unit / disk.unit;
  if (is_bounded && rises_too_far(disk, rules, uv, before)) return false;
  for (Vec2& u : uv) u *= disk.unit / unit;
  part.uv = std::move(uv);
  return overlaps_of(*part.chart, part.uv, intent.stop).empty();
}

/// The seeds of the split that a part with these flips needs. Both are empty where the part has the
/// guarantee, perhaps after a new map.
Seeds seeds_needed(GuaranteedPart& part, const std::vector<Index>& flipped, double unit,
                   const GuaranteeRules& rules, Mending& mending) {
  if (!flipped.empty()) {
    if (part.chart->mesh.face_count() == 1) fail("a triangle has no area in the map");
    return seeds_at_flips(*part.chart, flipped);
  }
  if (rules.guarantee != Guarantee::bijective) return {};
  const auto pairs = overlaps_of(*part.chart, part.uv, rules.intent.stop);
  if (pairs.empty()) return {};
  mending.overlaps += static_cast<Index>(pairs.size());
  const bool is_small = part.chart->mesh.face_count() <= kMostFacesUnfolded;
  if (is_small && !holds_any(rules.intent) && unfold(part, unit, rules)) return {};
  return seeds_at_overlaps(*part.chart, pairs);
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

/// Splits until every part has the guarantee. flipped: the flipped faces of the whole.
std::vector<GuaranteedPart> split_as_needed(GuaranteedPart whole, std::vector<Index> flipped,
                                            double unit, const GuaranteeRules& rules,
                                            Mending& mending) {
  std::vector<GuaranteedPart> open, kept;
  open.push_back(std::move(whole));
  for (bool is_whole = true; !open.empty(); is_whole = false) {
    GuaranteedPart part = std::move(open.back());
    open.pop_back();
    throw_if_cancelled(rules.intent.stop);
    if (!is_whole) flipped = flips_left(part, rules.intent);
    const Seeds seeds = seeds_needed(part, flipped, unit, rules, mending);
    if (seeds[0].empty())
      kept.push_back(std::move(part));
    else if (has_a_place(rules.intent))
      fail("the constraints leave no map without flips or overlaps");
    else
      split(part, seeds, rules.intent.stop, open);
  }
  return kept;
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
  kept.parts = split_as_needed({std::move(chart), std::move(uv)}, std::move(flipped), disk.unit,
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
        "written");
  const auto overlaps = static_cast<Index>(overlaps_of(chart, page_uv, rules.intent.stop).size());
  if (overlaps == 0 || rules.guarantee != Guarantee::bijective) return {0, overlaps};
  if (!separate_rounded_boundaries(chart, rules.intent.constrained, page_uv))
    fail("two triangles are too close to each other for the precision in which UVs are written");
  return {0, 0};
}

}  // namespace unwrapd::guarantee
