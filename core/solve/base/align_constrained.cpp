// Procrustes' problem in two dimensions (Umeyama 1991), in complex numbers: with positions p and q
// relative to their means, c = sum w conj(p) q has the angle of the best rotation.
//
// The scale is the ratio of the spreads, not Umeyama's |c| / sum w |p|^2. His shrinks as the
// targets resemble the map less, and is zero for mirrored ones. In ARAP and Hybrid the scale
// defines zero stretch, which must not depend on how well the targets fit.
#include "core/solve/base/align_constrained.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace unwrapd::solve {
namespace {

/// Constrained vertices nearer to each other than this, in disk units, determine no scale.
constexpr double kLeastSpread = 1e-9;

struct Pair {
  Vec2 from;
  Vec2 to;
  double weight;
};

std::vector<Pair> pairs_of(std::span<const Vec2> uv, const VertexConstraints& constraints) {
  std::vector<Pair> pairs;
  pairs.reserve(constraints.count());
  for (const HardConstraint& p : constraints.hard)
    pairs.push_back({uv[static_cast<std::size_t>(p.vertex)], p.at, 1});
  for (const SoftConstraint& s : constraints.soft)
    pairs.push_back({uv[static_cast<std::size_t>(s.vertex)], s.at, 1 / (1 + 1 / s.weight)});
  return pairs;
}

void subtract_means(std::vector<Pair>& pairs, Alignment& a) {
  double weight = 0;
  for (const Pair& p : pairs) weight += p.weight;
  for (const Pair& p : pairs) {
    a.from += p.weight / weight * p.from;
    a.to += p.weight / weight * p.to;
  }
  for (Pair& p : pairs) p.from -= a.from, p.to -= a.to;
}

}  // namespace

Alignment align(std::span<const Vec2> uv, const VertexConstraints& constraints) {
  assert(!constraints.empty());
  std::vector<Pair> pairs = pairs_of(uv, constraints);
  Alignment a;
  if (pairs.size() == 1) {
    a.from = pairs.front().from;
    a.to = pairs.front().to;
    return a;
  }
  subtract_means(pairs, a);
  double dot = 0, cross = 0, spread_from = 0, spread_to = 0;
  for (const Pair& p : pairs) {
    dot += p.weight * p.from.dot(p.to);
    cross += p.weight * (p.from.x() * p.to.y() - p.from.y() * p.to.x());
    spread_from += p.weight * p.from.squaredNorm();
    spread_to += p.weight * p.to.squaredNorm();
  }
  a.scale = std::sqrt(spread_to) / std::max(std::sqrt(spread_from), kLeastSpread);
  const double norm = std::hypot(dot, cross);
  if (norm > 0) a.cosine = dot / norm, a.sine = cross / norm;
  return a;
}

UvMap constrained_start(UvMap uv, const VertexConstraints& constraints) {
  const Alignment alignment = align(uv, constraints);
  for (Vec2& u : uv) u = alignment(u);
  for (const HardConstraint& p : constraints.hard) uv[static_cast<std::size_t>(p.vertex)] = p.at;
  return uv;
}

}  // namespace unwrapd::solve
