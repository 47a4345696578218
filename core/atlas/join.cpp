// The maps of both sides tell where their common border lies, twice; the motion that brings one to
// the other in least squares is a start for the map of both.
//
// Where two regions meet along more than one stretch they close to a tube or a cap that cannot lie
// flat, though glued along one stretch alone they would: a tube rolls out along a slit.
#include "core/atlas/join.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/cancel.hpp"
#include "core/mesh/disjoint_sets.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

constexpr double kFlatDefect = 0.3;  // radians that the angles at a vertex may lack, or exceed

/// A rotation about `from`, then the way to `to`.
struct Motion {
  double cosine = 1, sine = 0;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& u) const {
    const Vec2 x = u - from;
    return to + Vec2(cosine * x.x() - sine * x.y(), sine * x.x() + cosine * x.y());
  }
};

/// Of places in pairs {b, a}: the motion that brings every b near its a.
Motion motion_between(std::span<const std::array<Vec2, 2>> pairs) {
  Motion motion;
  for (const auto& [b, a] : pairs) {
    motion.from += b / static_cast<double>(pairs.size());
    motion.to += a / static_cast<double>(pairs.size());
  }
  double c = 0, s = 0;
  for (const auto& [b, a] : pairs) {
    const Vec2 x = b - motion.from, y = a - motion.to;
    c += x.dot(y);
    s += x.x() * y.y() - x.y() * y.x();
  }
  const double norm = std::hypot(c, s);
  if (norm > 0) motion.cosine = c / norm, motion.sine = s / norm;
  return motion;
}

std::vector<Index> ranks(const Sheet& sheet, const Region& region) {
  std::vector<Index> rank(sheet.mesh.faces.size(), -1);
  for (std::size_t k = 0; k < region.faces.size(); ++k)
    rank[region.faces[k]] = static_cast<Index>(k);
  return rank;
}

}  // namespace

Region beside(const Sheet& sheet, const Region& a, const Region& b, std::span<const Index> border) {
  const std::vector<Index> in_a = ranks(sheet, a), in_b = ranks(sheet, b);
  std::vector<std::array<Vec2, 2>> pairs;
  for (const Index h : border) {
    const Index twin = sheet.halfedges.twin[h];
    const CornerUv &own = b.uv[in_b[face_of(h)]], &across = a.uv[in_a[face_of(twin)]];
    pairs.push_back({own[h % 3], across[next_halfedge(twin) % 3]});
    pairs.push_back({own[next_halfedge(h) % 3], across[twin % 3]});
  }
  const Motion motion = motion_between(pairs);
  Region both = a;
  both.faces.insert(both.faces.end(), b.faces.begin(), b.faces.end());
  for (const auto& [p, q, r] : b.uv) both.uv.push_back({motion(p), motion(q), motion(r)});
  return both;
}

Joiner::Joiner(const Sheet& sheet) : sheet_(sheet) {
  std::vector<double> defect(sheet.mesh.positions.size(), 2 * std::numbers::pi);
  for (std::size_t t = 0; t < sheet.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      defect[sheet.mesh.faces[t][(i + 2) % 3]] -= std::atan2(1.0, sheet.rest[t].cot[i]);
  for (const double d : defect) is_flat_.push_back(std::abs(d) <= kFlatDefect ? 1 : 0);
}

/// The half-edges of b across which a lies.
std::vector<Index> Joiner::border(const Region& a, const Region& b,
                                  std::span<const char> open) const {
  const std::vector<Index> in_a = ranks(sheet_, a);
  std::vector<Index> border;
  for (const Index t : b.faces)
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = sheet_.halfedges.twin[h];
      if (twin != kNoTwin && open[h] == 0 && in_a[face_of(twin)] >= 0) border.push_back(h);
    }
  return border;
}

/// All of the border but its longest stretch; empty where it has but one.
std::vector<Index> Joiner::slit_of(std::span<const Index> border) const {
  DisjointSets stretches(border.size());
  std::map<Index, Index> at;  // vertex -> a side of the border there
  for (std::size_t k = 0; k < border.size(); ++k)
    for (const Index v :
         {start_of(sheet_.mesh.faces, border[k]), end_of(sheet_.mesh.faces, border[k])}) {
      if (is_flat_[v] == 0) continue;
      const auto [other, is_new] = at.try_emplace(v, static_cast<Index>(k));
      if (!is_new) stretches.join(static_cast<Index>(k), other->second);
    }
  std::map<Index, double> length;
  for (std::size_t k = 0; k < border.size(); ++k)
    length[stretches.root(static_cast<Index>(k))] += sheet_.length[border[k]];
  const auto longest = std::max_element(length.begin(), length.end(),
                                        [](auto& x, auto& y) { return x.second < y.second; });
  std::vector<Index> slit;
  for (std::size_t k = 0; k < border.size(); ++k) {
    if (stretches.root(static_cast<Index>(k)) == longest->first) continue;
    slit.push_back(border[k]);
    slit.push_back(sheet_.halfedges.twin[border[k]]);
  }
  return slit;
}

Joined Joiner::join(const MappedRegion& a, const MappedRegion& b, std::span<const char> open,
                    double cap, const TrialRules& trial) const {
  const std::vector<Index> common = border(a.region, b.region, open);
  const double area = a.area + b.area;
  TrialRules rules = trial;
  rules.most_excess = std::max(cap * area, (a.excess + b.excess).worst());
  Joined joined;
  const auto attempt = [&](std::span<const Index> glued, std::span<const char> cut) {
    joined.patch = {beside(sheet_, a.region, b.region, glued), {}, area, false};
    const TrialResult result = try_map(sheet_, cut, rules, joined.patch.region);
    joined.verdict = result.verdict;
    joined.patch.excess = result.excess;
    joined.patch.is_sound = result.verdict == Verdict::sound;
  };
  attempt(common, open);
  if (joined.patch.is_sound || is_cancelled(trial.stop)) return joined;
  joined.slit = slit_of(common);
  if (joined.slit.empty()) return joined;
  std::vector<char> cut(open.begin(), open.end());
  for (const Index h : joined.slit) cut[h] = 1;
  std::vector<Index> glued;
  for (const Index h : common)
    if (cut[h] == 0) glued.push_back(h);
  const Joined whole = joined;
  attempt(glued, cut);
  return joined.patch.is_sound ? joined : whole;
}

}  // namespace unwrapd
