// The maps of both sides tell where their common border lies, twice; the motion that brings one to
// the other in least squares is a start for the map of both.
//
// Where two regions meet along more than one stretch they close to a tube or a cap that cannot lie
// flat, though glued along one stretch alone they would: a tube rolls out along a slit.
//
// Where the maps miss each other by much at the border, hardly any map of both is sound, and of
// several stretches the longest may still be glued (ADR 0079). A wall that stands around a hole,
// rolled out, misses the hole's edge by .24 of its length: sqrt(1/12 - 1/(4 pi^2)).
//
// Rejected: lower bounds, and no trial where maps lie over each other (winding numbers on a grid):
// of the time that failures take it saves a half where it also turns down a twentieth of what is
// sound, and most failures lie side by side as neatly as what is sound.
#include "core/segment/join.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/cancel.hpp"
#include "core/mesh/disjoint_sets.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/labels.hpp"
#include "core/segment/ranks.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kFlatDefect = 0.3;  // radians that the angles at a vertex may lack, or exceed
constexpr double kMostMiss = 0.3;    // of the square root of the area of both
constexpr double kMostMissOfBorder = 0.2;  // of the length of the border

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

/// Root mean square of how far each b is from its a afterwards.
double miss_of(std::span<const std::array<Vec2, 2>> pairs, const Motion& motion) {
  double sum = 0;
  for (const auto& [b, a] : pairs) sum += (motion(b) - a).squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

/// Two regions, and where in them each face is.
class Pair {
 public:
  Pair(const SegmentationMesh& surface, const Region& a, const Region& b)
      : surface_(surface),
        a_(a),
        b_(b),
        in_a_(surface.mesh.faces.size(), a.faces),
        in_b_(surface.mesh.faces.size(), b.faces) {}

  /// The half-edges of b across which a lies.
  [[nodiscard]] std::vector<Index> border(std::span<const char> open) const {
    std::vector<Index> border;
    for (const Index t : b_.faces)
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Index twin = surface_.halfedges.twin[h];
        if (twin != kNoTwin && open[h] == 0 && in_a_[face_of(twin)] >= 0) border.push_back(h);
      }
    return border;
  }

  /// Where the ends of those half-edges lie in both maps, {b, a}.
  [[nodiscard]] std::vector<std::array<Vec2, 2>> ends(std::span<const Index> border) const {
    std::vector<std::array<Vec2, 2>> ends;
    for (const Index h : border) {
      const Index twin = surface_.halfedges.twin[h];
      const CornerUv &own = b_.uv[in_b_[face_of(h)]], &across = a_.uv[in_a_[face_of(twin)]];
      ends.push_back({own[h % 3], across[next_halfedge(twin) % 3]});
      ends.push_back({own[next_halfedge(h) % 3], across[twin % 3]});
    }
    return ends;
  }

  [[nodiscard]] Region beside(const Motion& motion) const {
    Region both = a_;
    both.faces.insert(both.faces.end(), b_.faces.begin(), b_.faces.end());
    for (const auto& [p, q, r] : b_.uv) both.uv.push_back({motion(p), motion(q), motion(r)});
    return both;
  }

 private:
  const SegmentationMesh& surface_;
  const Region &a_, &b_;
  Ranks in_a_, in_b_;
};

}  // namespace

Region beside(const SegmentationMesh& surface, const Region& a, const Region& b,
              std::span<const Index> border) {
  const Pair pair(surface, a, b);
  return pair.beside(motion_between(pair.ends(border)));
}

Joiner::Joiner(const SegmentationMesh& surface) : surface_(surface) {
  std::vector<double> defect(surface.mesh.positions.size(), 2 * std::numbers::pi);
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      defect[surface.mesh.faces[t][(i + 2) % 3]] -= std::atan2(1.0, surface.rest[t].cot[i]);
  for (const double d : defect) is_flat_.push_back(std::abs(d) <= kFlatDefect ? 1 : 0);
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
  const Pair pair(surface_, a.region, b.region);
  const std::vector<Index> common = pair.border(open);
  const double area = a.area + b.area;
  TestRules rules = trial;
  rules.most_excess = std::max(cap * area, (a.excess + b.excess).worst());
  Joined joined;
  const auto attempt = [&](std::span<const Index> glued, std::span<const char> cut) {
    const auto ends = pair.ends(glued);
    const Motion motion = motion_between(ends);
    const double miss = miss_of(ends, motion);
    joined.patch = {{}, {}, area, false};
    joined.verdict = Verdict::flawed;
    if (miss > kMostMiss * std::sqrt(area) || miss > kMostMissOfBorder * length_of(glued)) return;
    joined.patch.region = pair.beside(motion);
    const TestResult result = test_parameterization(surface_, cut, rules, joined.patch.region);
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

}  // namespace unwrapd::segment
