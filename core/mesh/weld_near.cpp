// Rounding moves the copies of a vertex apart by distances of one order, far below the length of
// edges. So the distances from every open edge to the nearest one along it have a gap in their
// histogram. The tolerance lies in the lowest gap that has most of the small distances below it.
//
// A real gap, such as a thin slit, can be as narrow as rounding. Rounding is different at every
// vertex, while the two sides of a slit keep their distance: the offsets at the two ends of an edge
// are then nearly equal. Edges that are connected are judged together, because one edge alone says
// little.
#include "core/mesh/weld_near.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "core/mesh/disjoint_sets.hpp"
#include "core/mesh/near_edges.hpp"

namespace unwrapd {
namespace {

constexpr double kSeen = 10;  // distances are compared up to this many times kMostTolerance
constexpr double kLeastSize = 1e-130;  // of a mesh whose distances can be squared
constexpr double kGap = 8;             // least ratio between the distances on both sides of a gap
constexpr double kOfGap = 2;           // the tolerance over the greatest distance below the gap
constexpr double kShare = 0.5;         // of the small distances that lie below the gap
constexpr double kCoherent = 0.9;      // correlation of offsets from which on they are a real gap
constexpr std::size_t kEnough = 8;     // edges that are judged without others
constexpr double kMostSpread = 2;      // of a set of welded vertices, in tolerances

double diagonal(const WeldedFaces& in) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const EdgeSide& side : in.sides) {
    const Vec3& position = in.mesh.positions[start_of(in.faces, side.halfedge)];
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  return in.sides.empty() ? 0 : (high - low).norm();
}

/// The distance from every open edge to the nearest one along it, or how far there is none.
std::vector<double> nearest_distances(std::span<const Vec3> positions,
                                      std::span<const OpenEdge> edges,
                                      std::span<const NearPair> pairs, double seen) {
  std::vector<double> nearest;
  for (const OpenEdge& edge : edges)
    nearest.push_back(std::min(seen, kReach * (positions[edge.high] - positions[edge.low]).norm()));
  for (const NearPair& pair : pairs)
    for (const std::size_t edge : {pair.first, pair.second})
      nearest[edge] = std::min(nearest[edge], pair.distance);
  return nearest;
}

/// The tolerance in the lowest gap; 0 if there is none.
double tolerance_of(std::vector<double> distances, double most) {
  std::sort(distances.begin(), distances.end());
  const auto small = std::upper_bound(distances.begin(), distances.end(), most);
  const auto least =
      static_cast<std::size_t>(kShare * static_cast<double>(small - distances.begin()));
  for (auto d = distances.begin(); d != small; ++d) {
    if (static_cast<std::size_t>(d - distances.begin()) + 1 < least) continue;
    if (d + 1 == distances.end() || d[1] >= kGap * *d) return std::min(kOfGap * *d, most);
  }
  return 0;
}

/// How alike the offsets at both ends of edges are.
struct Coherence {
  double product = 0, squares = 0;
  std::size_t count = 0;

  void add(const Coherence& other) {
    product += other.product;
    squares += other.squares;
    count += other.count;
  }
  [[nodiscard]] bool is_gap() const { return count > 0 && product >= kCoherent * squares; }
};

/// The vertices of the second edge that the low and the high end of the first edge meet.
std::array<Index, 2> partners(const OpenEdge& second, bool is_crossed) {
  if (is_crossed) return {second.high, second.low};
  return {second.low, second.high};
}

class GapFinder {
 public:
  GapFinder(std::span<const Vec3> positions, std::span<const OpenEdge> edges,
            std::span<const NearPair> pairs)
      : edges_(edges), connected_(positions.size()), of_set_(positions.size()) {
    for (const NearPair& pair : pairs) {
      const OpenEdge &a = edges[pair.first], &b = edges[pair.second];
      for (const Index v : {a.high, b.low, b.high}) connected_.join(v, a.low);
    }
    for (const NearPair& pair : pairs) {
      const OpenEdge& a = edges[pair.first];
      const auto [low, high] = partners(edges[pair.second], pair.is_crossed);
      if (low == a.low || high == a.high) continue;  // an end that is shared says nothing
      const Vec3 at_low = positions[low] - positions[a.low];
      const Vec3 at_high = positions[high] - positions[a.high];
      of_set_[connected_.root(a.low)].add(
          {at_low.dot(at_high), (at_low.squaredNorm() + at_high.squaredNorm()) / 2, 1});
    }
    for (const Coherence& set : of_set_)
      if (set.count < kEnough) few_.add(set);
  }

  [[nodiscard]] bool is_across_gap(const NearPair& pair) {
    const Coherence& set = of_set_[connected_.root(edges_[pair.first].low)];
    return set.count < kEnough ? few_.is_gap() : set.is_gap();
  }

 private:
  std::span<const OpenEdge> edges_;
  DisjointSets connected_;         // vertices, by pairs of edges
  std::vector<Coherence> of_set_;  // at the root of a set
  Coherence few_;                  // all sets of few edges together
};

struct VertexPair {
  double distance;
  Index low, high;
};

/// All ends that would meet, the nearest first.
std::vector<VertexPair> ends_that_meet(std::span<const Vec3> positions,
                                       std::span<const OpenEdge> edges,
                                       std::span<const NearPair> pairs) {
  std::vector<VertexPair> ends;
  const auto add = [&](Index a, Index b) {
    if (a != b)
      ends.push_back({(positions[a] - positions[b]).norm(), std::min(a, b), std::max(a, b)});
  };
  for (const NearPair& pair : pairs) {
    const OpenEdge& edge = edges[pair.first];
    const auto [low, high] = partners(edges[pair.second], pair.is_crossed);
    add(edge.low, low);
    add(edge.high, high);
  }
  std::ranges::sort(ends, {}, [](const VertexPair& pair) {
    return std::tuple(pair.distance, pair.low, pair.high);
  });
  return ends;
}

/// Sets of welded vertices, none of which has two corners of one face.
class VertexSets {
 public:
  explicit VertexSets(const WeldedFaces& in)
      : in_(in),
        sets_(in.mesh.positions.size()),
        next_(in.mesh.positions.size()),
        begin_(in.mesh.positions.size() + 1, 0),
        size_(in.mesh.positions.size(), 0) {
    for (std::size_t v = 0; v < next_.size(); ++v) next_[v] = static_cast<Index>(v);
    for (const EdgeSide& side : in.sides) ++begin_[start_of(in.faces, side.halfedge) + 1];
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    for (std::size_t v = 0; v < size_.size(); ++v) size_[v] = begin_[v + 1] - begin_[v];
    corner_.resize(in.sides.size());
    std::vector<Index> place(begin_.begin(), begin_.end() - 1);
    for (const EdgeSide& side : in.sides)
      corner_[place[start_of(in.faces, side.halfedge)]++] = side.halfedge;
  }

  Index root(Index v) { return sets_.root(v); }

  /// Welds two vertices, unless a face would collapse or the set would spread too far: false then.
  bool weld(const VertexPair& pair, double spread) {
    const auto [to, from] = std::minmax({root(pair.low), root(pair.high)});
    if (to == from) return false;
    if ((in_.mesh.positions[to] - in_.mesh.positions[from]).norm() > spread) return false;
    if (size_[from] < size_[to] ? share_face(from, to) : share_face(to, from)) return false;
    sets_.join(from, to);
    std::swap(next_[from], next_[to]);  // two rings become one
    size_[to] += size_[from];
    return true;
  }

 private:
  /// Whether a face has a corner in each of two sets; goes through the faces of the first.
  bool share_face(Index a, Index b) {
    Index v = a;
    do {
      for (Index k = begin_[v]; k < begin_[v + 1]; ++k)
        if (root(end_of(in_.faces, corner_[k])) == b || root(apex_of(in_.faces, corner_[k])) == b)
          return true;
      v = next_[v];
    } while (v != a);
    return false;
  }

  const WeldedFaces& in_;
  DisjointSets sets_;          // the root is the lowest vertex
  std::vector<Index> next_;    // of a ring through each set
  std::vector<Index> begin_;   // of a vertex in corner_
  std::vector<Index> corner_;  // the half-edges that start at a vertex
  std::vector<Index> size_;    // corners of a set, at its root
};

std::vector<Index> weld_ends(const WeldedFaces& in, std::span<const VertexPair> ends, double spread,
                             const std::stop_token& stop) {
  VertexSets sets(in);
  bool is_any_welded = false;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    check_cancelled_every(k, stop);
    is_any_welded |= sets.weld(ends[k], spread);
  }
  if (!is_any_welded) return {};
  std::vector<Index> welded(in.mesh.positions.size());
  for (std::size_t v = 0; v < welded.size(); ++v) welded[v] = sets.root(static_cast<Index>(v));
  return welded;
}

}  // namespace

std::vector<Index> weld_near(const WeldedFaces& in, std::optional<double> distance,
                             const std::stop_token& stop) {
  const std::vector<OpenEdge> edges = open_edges(in.faces, in.sides, stop);
  if (edges.size() < 2) return {};
  const std::span<const Vec3> positions = in.mesh.positions;
  const double size = diagonal(in);
  if (!(size > kLeastSize && size < 1 / kLeastSize)) return {};
  const double most = kMostTolerance * size;
  const double seen = distance.value_or(kSeen * most);
  std::vector<NearPair> pairs = near_pairs(positions, edges, seen, stop);
  if (pairs.empty()) return {};
  const double tolerance =
      distance ? *distance : tolerance_of(nearest_distances(positions, edges, pairs, seen), most);
  std::erase_if(pairs, [&](const NearPair& pair) { return pair.distance > tolerance; });
  if (!distance) {
    GapFinder gaps(positions, edges, pairs);
    std::erase_if(pairs, [&](const NearPair& pair) { return gaps.is_across_gap(pair); });
  }
  if (pairs.empty()) return {};
  return weld_ends(in, ends_that_meet(positions, edges, pairs), kMostSpread * tolerance, stop);
}

}  // namespace unwrapd
