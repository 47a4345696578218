// Edges are compared by their midpoints, not their ends: a vertex of a fan has as many copies as
// the fan has faces, an edge has two.
#include "core/mesh/near_edges.hpp"

#include <algorithm>
#include <numeric>

#include "core/mesh/counting_sort.hpp"
#include "core/mesh/point_tree.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kMostCandidates = 16;
constexpr double kFold = 4;  // faces no further apart than this many distances of their edges

double length(std::span<const Vec3> positions, const OpenEdge& edge) {
  return (positions[edge.high] - positions[edge.low]).norm();
}

NearPair compare(std::span<const Vec3> positions, std::span<const OpenEdge> edges, std::size_t g,
                 std::size_t h) {
  const auto apart = [&](Index a, Index b) { return (positions[a] - positions[b]).norm(); };
  const OpenEdge &a = edges[g], &b = edges[h];
  const double straight = std::max(apart(a.low, b.low), apart(a.high, b.high));
  const double crossed = std::max(apart(a.low, b.high), apart(a.high, b.low));
  return {std::min(g, h), std::max(g, h), std::min(straight, crossed), crossed < straight};
}

bool are_joined(const OpenEdge& a, const OpenEdge& b) {
  return a.apex == b.low || a.apex == b.high || b.apex == a.low || b.apex == a.high;
}

/// From an edge to its face's third vertex, across the edge.
Vec3 across(std::span<const Vec3> positions, const OpenEdge& edge) {
  const Vec3 along = (positions[edge.high] - positions[edge.low]).normalized();
  const Vec3 to_apex = positions[edge.apex] - positions[edge.low];
  return to_apex - along * along.dot(to_apex);
}

/// Whether the two faces lie on each other, as far apart as their edges: the sides of a thin wall.
bool is_fold(std::span<const Vec3> positions, const OpenEdge& a, const OpenEdge& b,
             double distance) {
  const Vec3 u = across(positions, a), v = across(positions, b);
  if (u.dot(v) <= 0) return false;
  const double height = std::min(u.norm(), v.norm());
  return (u.normalized() - v.normalized()).norm() * height <= kFold * distance;
}

}  // namespace

std::vector<OpenEdge> open_edges(std::span<const Triangle> welded,
                                 const std::vector<EdgeSide>& sides, const std::stop_token& stop) {
  std::vector<OpenEdge> edges;
  for_each_run(
      sides, on_one_edge,
      [&](const EdgeSide* first, const EdgeSide* last) {
        if (last - first == 1)
          edges.push_back({first->low, first->high, apex_of(welded, first->halfedge)});
      },
      stop);
  return edges;
}

std::vector<NearPair> near_pairs(std::span<const Vec3> positions, std::span<const OpenEdge> edges,
                                 double reach, const std::stop_token& stop) {
  std::vector<Vec3> midpoints;
  for (const OpenEdge& edge : edges)
    midpoints.emplace_back(positions[edge.low] / 2 + positions[edge.high] / 2);
  std::vector<Index> all(edges.size());
  std::iota(all.begin(), all.end(), 0);
  const PointTree tree(midpoints, std::move(all));
  std::vector<NearPair> pairs;
  for (std::size_t g = 0; g < edges.size(); ++g) {
    check_cancelled_every(16 * g, stop);
    const double own = std::min(reach, kReach * length(positions, edges[g]));
    for (const Index k : tree.nearest_within(midpoints[g], own, kMostCandidates)) {
      const auto h = static_cast<std::size_t>(k);
      if (h == g || are_joined(edges[g], edges[h])) continue;
      const NearPair pair = compare(positions, edges, g, h);
      const double most = std::min(own, kReach * length(positions, edges[h]));
      if (pair.distance <= most && !is_fold(positions, edges[g], edges[h], pair.distance))
        pairs.push_back(pair);
    }
  }
  const auto key = [](const NearPair& pair) { return std::pair(pair.first, pair.second); };
  std::ranges::sort(pairs, {}, key);
  const auto is_same = [&](const NearPair& a, const NearPair& b) { return key(a) == key(b); };
  pairs.erase(std::unique(pairs.begin(), pairs.end(), is_same), pairs.end());
  return pairs;
}

}  // namespace unwrapd
