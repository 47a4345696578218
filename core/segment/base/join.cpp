// Where two regions meet along more than one stretch they close to a tube or a cap that cannot lie
// flat, though glued along one stretch alone they would: a tube rolls out along a slit.
//
// Where the maps miss each other by much at the border, hardly any map of both is sound, and of
// several stretches the longest may still be glued (ADR 0079). A wall that stands around a hole,
// rolled out, misses the hole's edge by .24 of its length: sqrt(1/12 - 1/(4 pi^2)).
//
// Where most of a small region lies on the map of a large one before the trial, hardly any map of
// both is sound (ADR 0080). Of regions of like sizes that tells too little: it saves half the time
// that failures take where it also turns down a twentieth of what is sound.
//
// Rejected: lower bounds; most failures lie side by side as neatly as what is sound.
#include "core/segment/base/join.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/mesh/disjoint_sets.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/base/labels.hpp"
#include "core/segment/base/region_mesh.hpp"
#include "core/segment/base/region_pair.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kFlatDefect = 0.3;  // radians that the angles at a vertex may lack, or exceed
constexpr double kMostMiss = 0.3;    // of the square root of the area of both
constexpr double kMostMissOfBorder = 0.2;  // of the length of the border
constexpr double kMostAdded = 0.03;        // of a region, before all of it is mapped anew
constexpr std::size_t kManyFaces = 1000;   // faces
constexpr std::size_t kSmall = 8;          // times fewer faces than a large region
constexpr double kMostCovered = 0.5;       // of a small region
constexpr std::size_t kFewFaces = 4;       // tell too little of what is covered
constexpr std::size_t kPartsTried = 4;     // of a stretch, of each length
constexpr std::size_t kEdgesTried = 24;    // of a border

/// Whether hardly any map of both would be sound. area: of both; length: of the border.
bool is_hopeless(const RegionPair& pair, const Placement& placement, std::span<const char> open,
                 double area, double length) {
  if (placement.miss > kMostMiss * std::sqrt(area) || placement.miss > kMostMissOfBorder * length)
    return true;
  return pair.b().faces.size() >= kFewFaces && is_small_beside(pair.b(), pair.a()) &&
         pair.covered(placement, open) > kMostCovered;
}

std::vector<Index> without(std::span<const Index> sides, std::span<const Index> some) {
  const std::set<Index> left_out(some.begin(), some.end());
  std::vector<Index> rest;
  for (const Index h : sides)
    if (!left_out.contains(h)) rest.push_back(h);
  return rest;
}

/// Parts of a walk along the border: a half of it long, an eighth, and so on. Of each length those
/// come first where the maps miss each other least.
std::vector<std::span<const Index>> parts_of(const RegionPair& pair, std::span<const Index> walk) {
  std::vector<std::span<const Index>> all;
  for (std::size_t sides = (walk.size() + 1) / 2;; sides /= 4) {
    std::vector<std::pair<double, std::size_t>> parts;  // miss, where it begins
    for (std::size_t k = 0; k + sides <= walk.size(); k += (sides + 1) / 2)
      parts.emplace_back(rounded(pair.miss(walk.subspan(k, sides))), k);
    std::ranges::sort(parts);
    parts.resize(std::min(parts.size(), kPartsTried));
    for (const auto& [miss, k] : parts) all.push_back(walk.subspan(k, sides));
    if (sides < 4) return all;
  }
}

/// Edges of the border at which none of b would lie on a. Those come first where the maps miss each
/// other least.
std::vector<std::span<const Index>> free_edges(const RegionPair& pair,
                                               std::span<const Index> border,
                                               std::span<const char> open) {
  std::vector<std::pair<double, std::size_t>> edges;  // miss, place in the border
  for (std::size_t k = 0; k < border.size(); ++k)
    edges.emplace_back(rounded(pair.miss(border.subspan(k, 1))), k);
  std::ranges::sort(edges);
  std::vector<std::span<const Index>> free;
  for (const auto& [miss, k] : edges) {
    if (free.size() == kEdgesTried) break;
    const std::span<const Index> edge = border.subspan(k, 1);
    if (pair.covered(pair.place(edge), open) == 0) free.push_back(edge);
  }
  return free;
}

}  // namespace

ExcessDistortion total_excess(std::span<const MappedRegion> regions) {
  ExcessDistortion total;
  for (const MappedRegion& region : regions) total += region.excess;
  return total;
}

bool is_small_beside(const Region& b, const Region& a) {
  return a.faces.size() >= std::max(kManyFaces, kSmall * b.faces.size());
}

MappedRegion unite(const MappedRegion& a, const MappedRegion& b, Region laid) {
  MappedRegion both{std::move(laid)};
  both.area = a.area + b.area;
  const double added = a.area_added + b.area;
  if (added > kMostAdded * both.area || !is_small_beside(b, a) ||
      2 * moving_count(b.faces.size()) > both.faces.size())
    return both;
  both.area_added = added;
  both.mapped = a.faces.size();
  return both;
}

Joiner::Joiner(const SegmentationMesh& surface) : surface_(surface) {
  std::vector<double> defect(surface.mesh.positions.size(), 2 * std::numbers::pi);
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      defect[surface.mesh.faces[t][(i + 2) % 3]] -= std::atan2(1.0, surface.rest[t].cot[i]);
  for (const double d : defect) is_flat_.push_back(std::abs(d) <= kFlatDefect ? 1 : 0);
}

std::vector<Index> Joiner::both_sides(std::span<const Index> border) const {
  std::vector<Index> both;
  for (const Index h : border) {
    both.push_back(h);
    both.push_back(surface_.halfedges.twin[h]);
  }
  return both;
}

double Joiner::length_of(std::span<const Index> border) const {
  double length = 0;
  for (const Index h : border) length += surface_.length[h];
  return length;
}

/// All of the border but its longest stretch; empty where it has but one.
std::vector<Index> Joiner::slit_of(std::span<const Index> border) const {
  DisjointSets stretches(border.size());
  std::map<Index, Index> at;  // vertex -> a side of the border there
  for (std::size_t k = 0; k < border.size(); ++k)
    for (const Index v :
         {start_of(surface_.mesh.faces, border[k]), end_of(surface_.mesh.faces, border[k])}) {
      if (is_flat_[v] == 0) continue;
      const auto [other, is_new] = at.try_emplace(v, static_cast<Index>(k));
      if (!is_new) stretches.join(static_cast<Index>(k), other->second);
    }
  std::map<Index, double> length;
  for (std::size_t k = 0; k < border.size(); ++k)
    length[stretches.root(static_cast<Index>(k))] += surface_.length[border[k]];
  const auto longest = std::ranges::max_element(
      length, {}, [](const auto& stretch) { return rounded(stretch.second); });
  std::vector<Index> slit;
  for (std::size_t k = 0; k < border.size(); ++k) {
    if (stretches.root(static_cast<Index>(k)) == longest->first) continue;
    slit.push_back(border[k]);
    slit.push_back(surface_.halfedges.twin[border[k]]);
  }
  return slit;
}

Joined Joiner::join(const MappedRegion& a, const MappedRegion& b, std::span<const char> open,
                    double cap, const TestRules& trial) const {
  if (is_small_beside(a, b)) return join(b, a, open, cap, trial);
  const RegionPair pair(surface_, a, b);
  const std::vector<Index> common = pair.border(open);
  TestRules rules = trial;
  rules.most_excess = std::max(cap * (a.area + b.area), (a.excess + b.excess).worst());
  Joined joined;
  const auto attempt = [&](std::span<const Index> glued, std::span<const char> cut) {
    Placement placement = pair.place(glued);
    joined.region = {};
    joined.verdict = Verdict::flawed;
    if (is_hopeless(pair, placement, open, a.area + b.area, length_of(glued))) return;
    joined.region = unite(a, b, std::move(placement.both));
    const TestResult result = test_parameterization(surface_, cut, rules, joined.region);
    joined.verdict = result.verdict;
    joined.region.excess = result.excess;
    joined.region.is_sound = result.verdict == Verdict::sound;
  };
  attempt(common, open);
  if (joined.region.is_sound || is_cancelled(trial.stop)) return joined;
  joined.slit = slit_of(common);
  if (joined.slit.empty()) return joined;
  std::vector<char> cut(open.begin(), open.end());
  for (const Index h : joined.slit) cut[h] = 1;
  std::vector<Index> glued;
  for (const Index h : common)
    if (cut[h] == 0) glued.push_back(h);
  const Joined whole = joined;
  attempt(glued, cut);
  return joined.region.is_sound ? joined : whole;
}

/// The longest stretch of the border, as a walk along it.
std::vector<Index> Joiner::longest_stretch(std::span<const Index> border) const {
  std::vector<Index> stretch = without(border, slit_of(border));
  std::map<Index, Index> from, to;  // vertex -> the side that starts there, and that ends
  for (const Index h : stretch) {
    from[start_of(surface_.mesh.faces, h)] = h;
    to[end_of(surface_.mesh.faces, h)] = h;
  }
  Index first = stretch.front();
  for (std::size_t k = 0; k < stretch.size() && to.contains(start_of(surface_.mesh.faces, first));
       ++k)
    first = to.at(start_of(surface_.mesh.faces, first));
  std::vector<Index> walk{first};
  for (auto next = from.find(end_of(surface_.mesh.faces, first));
       next != from.end() && next->second != first && walk.size() < stretch.size();
       next = from.find(end_of(surface_.mesh.faces, walk.back())))
    walk.push_back(next->second);
  return walk;
}

Joined Joiner::force(const MappedRegion& a, const MappedRegion& b, std::span<const char> open,
                     const TestRules& trial, const MapAnyhow& map) const {
  if (is_small_beside(a, b)) return force(b, a, open, trial, map);
  const RegionPair pair(surface_, a, b);
  const std::vector<Index> common = pair.border(open);
  const auto joined_along = [&](std::span<const Index> glued, const MapAnyhow& by) {
    Joined joined{unite(a, b, pair.place(glued).both), Verdict::impossible,
                  both_sides(without(common, glued))};
    std::vector<char> cut(open.begin(), open.end());
    for (const Index h : joined.slit) cut[h] = 1;
    const TestResult result = by(cut, joined.region);
    joined.verdict = result.verdict;
    joined.region.excess = result.excess;
    if (joined.verdict == Verdict::sound && result.excess.worst() > trial.most_excess)
      joined.verdict = Verdict::distorted;
    joined.region.is_sound = joined.verdict != Verdict::impossible;
    joined.region.is_forced = true;
    return joined;
  };
  Joined all = joined_along(common, map);
  if (all.verdict == Verdict::sound || is_cancelled(trial.stop)) return all;
  const MapAnyhow beside = [&](std::span<const char> cut, Region& region) {
    return test_parameterization(surface_, cut, trial, region);
  };
  const std::vector<Index> stretch = longest_stretch(common);
  std::vector<std::span<const Index>> parts = parts_of(pair, stretch);
  for (const std::span<const Index> edge : free_edges(pair, common, open)) parts.push_back(edge);
  for (const std::span<const Index> part : parts) {
    if (is_cancelled(trial.stop)) return all;
    Joined along_part = joined_along(part, beside);
    if (along_part.verdict == Verdict::sound) return along_part;
  }
  std::vector<double> covered;
  for (const std::span<const Index> part : parts)
    covered.push_back(rounded(pair.covered(pair.place(part), open)));
  const auto least = std::ranges::min_element(covered) - covered.begin();
  return joined_along(parts[static_cast<std::size_t>(least)], map);
}

}  // namespace unwrapd::segment
