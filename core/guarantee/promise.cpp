// First in place (flips are untangled, or the virtual boundary of Sec. 4.4 is used); a chart that
// lies on itself is mapped anew with a barrier between its boundaries. What neither helps is split:
// parts keep their share of the map, so that only the seam is lost. A part that still breaks the
// promise is treated in the same way; in the end single triangles keep any promise.
#include "core/guarantee/promise.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/split_chart.hpp"
#include "core/guarantee/part_on_page.hpp"
#include "core/guarantee/snap.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/solve/repair/bijective.hpp"
#include "core/solve/repair/virtual_patches.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kMostPairs = 1 << 20;   // of overlapping triangles, counted in one chart
constexpr Index kMostFacesUnfolded = 50'000;  // a new map of more takes minutes

double fit_energy_of(const Disk& disk, const UvMap& uv, const Rigidity& rigidity) {
  double energy = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    look_now_and_then(t, disk.stop);
    const Jacobian j = jacobian(disk.rest[t], uv_edges(disk.faces[t], uv));
    const double lambda = rigidity.at(disk.rest[t].area);
    energy += fit_energy(j, fit_similarity(j, lambda), disk.rest[t].area, lambda);
  }
  return energy;
}

/// The method's own energy of a map: for angles D_angle, which flipped triangles have too.
double energy_of(const Disk& disk, const UvMap& uv, const MapIntent& intent) {
  SerialExecutor serial;
  switch (intent.own) {
    case OwnEnergy::symmetric_dirichlet:
      return symmetric_dirichlet_energy(disk, uv, serial);
    case OwnEnergy::mips:
      return distortion_sums(disk.rest, disk.faces, uv, disk.stop).angle;
    default:
      return fit_energy_of(disk, uv, intent.rigidity);
  }
}

/// That of an isometric map.
double least_energy(const Disk& disk, const MapIntent& intent) {
  double area = 0;
  for (const RestTriangle& rest : disk.rest) area += rest.area;
  switch (intent.own) {
    case OwnEnergy::symmetric_dirichlet:
      return 4 * area;
    case OwnEnergy::mips:
      return 2 * area;
    default:
      return 0;
  }
}

/// Whether what a map's energy has above the least is more than `most` times that of another.
bool exceeds(const Disk& disk, const MapIntent& intent, double most, const UvMap& uv,
             const UvMap& other) {
  const double least = least_energy(disk, intent);
  return energy_of(disk, uv, intent) - least > most * (energy_of(disk, other, intent) - least);
}

bool holds_any(const MapIntent& intent) {
  return std::any_of(intent.held.begin(), intent.held.end(), [](char h) { return h != 0; });
}

/// Parts are packed wherever there is room: a chart whose places were asked for stays whole.
bool has_a_place(const MapIntent& intent) { return holds_any(intent) || !intent.springs.empty(); }

/// Mends the map of one disk; returns how many flips are left.
Index mend(const Disk& disk, const Promise& promise, UvMap& uv, Mending& mending) {
  mending.virtual_boundary = promise.repair == RepairMethod::virtual_boundary &&
                             mend_by_virtual_boundary(disk, promise.intent, uv);
  return untangle(disk, promise.intent, uv);
}

/// Faces that must come apart: two sets, disjoint, none empty.
using Seeds = std::array<std::vector<Index>, 2>;

/// A flipped face and the rest of the chart's rim, so that each part has less to hold together.
Seeds seeds_at_flips(const Chart& chart, const std::vector<Index>& flipped) {
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
std::vector<Index> component_numbers(const Chart& chart, const std::vector<char>& in_set) {
  Halfedges cut = chart.halfedges;
  for (std::size_t h = 0; h < cut.twin.size(); ++h)
    if (cut.twin[h] != kNoTwin && in_set[cut.twin[h] / 3] != in_set[h / 3]) cut.twin[h] = kNoTwin;
  return topology(corner_vertices(cut).faces, cut).component_of;
}

/// The two regions of the first overlap whole, where they do not hang together; else the two faces.
Seeds seeds_at_overlaps(const Chart& chart, const std::vector<std::array<Index, 2>>& pairs) {
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

std::vector<std::array<Index, 2>> overlaps_of(const Chart& chart, const UvMap& uv,
                                              const std::stop_token& stop) {
  if (is_plainly_injective(chart.mesh.faces, chart.loops, uv, stop)) return {};
  throw_if_cancelled(stop);
  return overlapping_pairs(chart.mesh.faces, chart.loops, uv, kMostPairs, stop);
}

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorCode::guarantee_failed,
              why + "; relax the constraints, or use guarantee=none to get the raw map",
              "/guarantee");
}

/// Splits a part in two or more and puts them on the list of those to be looked at.
void split(const KeptPart& part, const Seeds& seeds, const std::stop_token& stop,
           std::vector<KeptPart>& open) {
  throw_if_cancelled(stop);
  for (ChartPart& piece : split_chart(*part.chart, seeds, stop)) {
    throw_if_cancelled(stop);
    UvMap uv;
    for (Index v : piece.vertex) uv.push_back(part.uv[v]);
    open.push_back({std::make_shared<const Chart>(std::move(piece.chart)), std::move(uv)});
  }
}

/// A map of the part in which nothing overlaps, in units of which one is `unit` of the mesh's,
/// drawn by the springs. The part stays as it is where there is none, or none that is good enough.
bool unfold(KeptPart& part, double unit, const Promise& promise) {
  const MapIntent& intent = promise.intent;
  const Disk disk = make_disk(part.chart->mesh, part.chart->loops, intent.stop);
  UvMap uv = part.uv;
  if (!map_injectively(disk, intent, uv)) return false;
  const bool is_bounded = promise.most_rise < std::numeric_limits<double>::infinity();
  UvMap before = is_bounded ? part.uv : UvMap();
  for (Vec2& u : before) u *= unit / disk.unit;
  if (is_bounded && exceeds(disk, intent, 1 + promise.most_rise, uv, before)) return false;
  for (Vec2& u : uv) u *= disk.unit / unit;
  part.uv = std::move(uv);
  return overlaps_of(*part.chart, part.uv, intent.stop).empty();
}

/// The seeds of the split that a part with these flips needs; both empty where it keeps the
/// promise, if need be after a new map.
Seeds seeds_needed(KeptPart& part, const std::vector<Index>& flipped, double unit,
                   const Promise& promise, Mending& mending) {
  if (!flipped.empty()) {
    if (part.chart->mesh.face_count() == 1) fail("a triangle has no area in the map");
    return seeds_at_flips(*part.chart, flipped);
  }
  if (promise.guarantee != Guarantee::bijective) return {};
  const auto pairs = overlaps_of(*part.chart, part.uv, promise.intent.stop);
  if (pairs.empty()) return {};
  mending.overlaps += static_cast<Index>(pairs.size());
  const bool is_small = part.chart->mesh.face_count() <= kMostFacesUnfolded;
  if (is_small && !holds_any(promise.intent) && unfold(part, unit, promise)) return {};
  return seeds_at_overlaps(*part.chart, pairs);
}

/// The flips of a part that was cut off for its flips: it may be untangled where the whole could
/// not.
std::vector<Index> flips_left(KeptPart& part, const MapIntent& intent) {
  std::vector<Index> flipped = flipped_faces(part.chart->mesh.faces, part.uv, intent.stop);
  if (flipped.empty()) return flipped;
  const Disk disk = make_disk(part.chart->mesh, part.chart->loops, intent.stop);
  untangle(
      disk,
      {.rigidity = intent.rigidity, .held = {}, .stop = intent.stop, .executor = intent.executor},
      part.uv);
  return flipped_faces(part.chart->mesh.faces, part.uv);
}

/// Splits until every part keeps the promise. flipped: those of the whole.
std::vector<KeptPart> split_as_needed(KeptPart whole, std::vector<Index> flipped, double unit,
                                      const Promise& promise, Mending& mending) {
  std::vector<KeptPart> open, kept;
  open.push_back(std::move(whole));
  for (bool is_whole = true; !open.empty(); is_whole = false) {
    KeptPart part = std::move(open.back());
    open.pop_back();
    throw_if_cancelled(promise.intent.stop);
    if (!is_whole) flipped = flips_left(part, promise.intent);
    const Seeds seeds = seeds_needed(part, flipped, unit, promise, mending);
    if (seeds[0].empty())
      kept.push_back(std::move(part));
    else if (has_a_place(promise.intent))
      fail("the constraints leave no map without flips or overlaps");
    else
      split(part, seeds, promise.intent.stop, open);
  }
  return kept;
}

}  // namespace

Kept keep_promise(std::shared_ptr<const Chart> chart, const Disk& disk, UvMap uv,
                  const Promise& promise) {
  Kept kept;
  if (promise.guarantee == Guarantee::none) {
    kept.parts.push_back({std::move(chart), std::move(uv)});
    return kept;
  }
  throw_if_cancelled(promise.intent.stop);
  std::vector<Index> flipped = flipped_faces(disk.faces, uv, promise.intent.stop);
  kept.mending.flips = static_cast<Index>(flipped.size());
  const bool may_change = kept.mending.flips > 0 || promise.guarantee == Guarantee::bijective;
  const UvMap before = may_change ? uv : UvMap();
  const auto rise = [&](const UvMap& now) {
    const double energy = energy_of(disk, before, promise.intent);
    return energy > 0 ? std::max(0.0, energy_of(disk, now, promise.intent) / energy - 1) : 0;
  };
  if (!flipped.empty()) {
    if (mend(disk, promise, uv, kept.mending) == 0) kept.mending.energy_rise = rise(uv);
    flipped = flipped_faces(disk.faces, uv);
  }
  kept.parts = split_as_needed({std::move(chart), std::move(uv)}, std::move(flipped), disk.unit,
                               promise, kept.mending);
  throw_if_cancelled(promise.intent.stop);
  if (kept.mending.overlaps > 0 && kept.parts.size() == 1)
    kept.mending.energy_rise = rise(kept.parts.front().uv);
  kept.mending.parts = static_cast<Index>(kept.parts.size());
  return kept;
}

Written keep_on_page(const Chart& chart, const Promise& promise, UvMap& page_uv) {
  if (promise.guarantee == Guarantee::none) {
    round_to_step(page_uv, promise.intent.held);
    return {static_cast<Index>(flipped_faces(chart.mesh.faces, page_uv).size()), {}};
  }
  if (snap(chart, promise.intent.held, promise.intent.stop, page_uv) > 0)
    fail(
        "a triangle is too small, compared with the page, for the precision in which UVs are "
        "written");
  const auto overlaps = static_cast<Index>(overlaps_of(chart, page_uv, promise.intent.stop).size());
  if (overlaps == 0 || promise.guarantee != Guarantee::bijective) return {0, overlaps};
  if (!part_on_page(chart, promise.intent.held, page_uv))
    fail("two triangles are too close to each other for the precision in which UVs are written");
  return {0, 0};
}

}  // namespace unwrapd
