// Finds the farthest pair by pruning. A good pair comes from repeated farthest-point steps. Only
// points far enough from the centre can then belong to a better pair; of those, sorted by their
// distance from the centre, only pairs whose distances add up to more.
#include <algorithm>
#include <array>
#include <cstdint>

#include "core/solve/maps/conformal.hpp"

namespace unwrapd::solve::maps {
namespace {

constexpr std::int64_t kMaxPairs = 20'000'000;

struct Pair {
  Index a = 0, b = 0;
  double distance = -1;

  void offer(Index i, Index j, double d) {
    if (d > distance) *this = {std::min(i, j), std::max(i, j), d};
  }
};

Pair farthest_of_farthest(std::span<const Vec3> p, Index start) {
  Pair best;
  for (Index from = start;;) {
    Pair step;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (static_cast<Index>(i) != from)
        step.offer(from, static_cast<Index>(i), (p[i] - p[static_cast<std::size_t>(from)]).norm());
    if (step.distance <= best.distance) return best;
    best = step;
    from = step.a == from ? step.b : step.a;
  }
}

struct PointAtDistance {
  double radius;
  Index vertex;
};

}  // namespace

std::array<Index, 2> diameter(std::span<const Vec3> positions) {
  std::vector<PointAtDistance> ranked(positions.size());
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : positions) centre += p / static_cast<double>(positions.size());
  for (std::size_t v = 0; v < ranked.size(); ++v)
    ranked[v] = {(positions[v] - centre).norm(), static_cast<Index>(v)};
  std::stable_sort(
      ranked.begin(), ranked.end(),
      [](const PointAtDistance& x, const PointAtDistance& y) { return x.radius > y.radius; });

  Pair best = farthest_of_farthest(positions, ranked.front().vertex);
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < ranked.size() && pairs < kMaxPairs; ++i)
    for (std::size_t j = i + 1; j < ranked.size(); ++j, ++pairs) {
      if (ranked[i].radius + ranked[j].radius <= best.distance) break;
      const auto v = static_cast<std::size_t>(ranked[i].vertex);
      const auto w = static_cast<std::size_t>(ranked[j].vertex);
      best.offer(ranked[i].vertex, ranked[j].vertex, (positions[v] - positions[w]).norm());
    }
  return {best.a, best.b};
}

}  // namespace unwrapd::solve::maps
