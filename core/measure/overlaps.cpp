// Two triangles are disjoint exactly if the line along a side of one of them has the other on its
// far side (separating axes). Candidates come from a tree of boxes over the items in the order of a
// Z curve. It needs no cell size, and slivers across the page only cost the boxes that they meet.
//
// Rejected: a sweep line, which needs exact orders of crossing points; a grid, which suffers from
// varying sizes.
#include "core/measure/overlaps.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/base/cancel.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/winding.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::measure {
namespace {

constexpr std::size_t kStepsBetweenLooks = 4096;

struct Bounds {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  [[nodiscard]] bool meets(const Bounds& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// Bits of x at even places.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 16) & 0x0000ffff0000ffff;
  x = (x | x << 8) & 0x00ff00ff00ff00ff;
  x = (x | x << 4) & 0x0f0f0f0f0f0f0f0f;
  x = (x | x << 2) & 0x3333333333333333;
  return (x | x << 1) & 0x5555555555555555;
}

/// A complete binary tree over items, stored as a heap.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Bounds>& items) : order_(items.size()) {
    Bounds all;
    for (const Bounds& item : items) all.add(item);
    std::vector<std::uint64_t> code;
    for (const Bounds& item : items) code.push_back(code_of(item, all));
    for (std::size_t k = 0; k < order_.size(); ++k) order_[k] = static_cast<Index>(k);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](Index a, Index b) { return code[a] < code[b]; });
    leaves_ = std::bit_ceil(std::max<std::size_t>(items.size(), 1));
    node_.resize(2 * leaves_);
    for (std::size_t k = 0; k < items.size(); ++k) node_[leaves_ + k] = items[order_[k]];
    for (std::size_t k = leaves_; k-- > 1;) {
      node_[k].add(node_[2 * k]);
      node_[k].add(node_[2 * k + 1]);
    }
  }

  /// Calls visit(item) for all items whose bounds meet `bounds`, borders included.
  template <class Visit>
  void query(const Bounds& bounds, Visit visit) const {
    std::array<std::size_t, 128> open{1};
    for (std::size_t size = 1; size > 0;) {
      const std::size_t k = open[--size];
      if (!node_[k].meets(bounds)) continue;
      if (k >= leaves_) {
        visit(order_[k - leaves_]);
        continue;
      }
      open[size++] = 2 * k + 1;
      open[size++] = 2 * k;
    }
  }

 private:
  static std::uint64_t code_of(const Bounds& item, const Bounds& all) {
    const Vec2 size = (all.high - all.low).cwiseMax(std::numeric_limits<double>::min());
    const Vec2 at = ((item.low + item.high) / 2 - all.low).cwiseQuotient(size) * 0x1p31;
    return spread_bits(static_cast<std::uint64_t>(at.x())) |
           spread_bits(static_cast<std::uint64_t>(at.y())) << 1;
  }

  std::vector<Index> order_;
  std::vector<Bounds> node_;
  std::size_t leaves_ = 1;
};

std::array<Vec2, 3> corners(const Triangle& face, std::span<const Vec2> uv) {
  const auto at = [&](int i) { return uv[static_cast<std::size_t>(face[i])]; };
  return {at(0), at(1), at(2)};
}

/// Whether all of b lies on the right of, or on, the line along a side of the counter-clockwise
/// triangle a.
bool a_side_separates(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 &from = a[i], &to = a[(i + 1) % 3];
    if (orientation(from, to, b[0]) <= 0 && orientation(from, to, b[1]) <= 0 &&
        orientation(from, to, b[2]) <= 0)
      return true;
  }
  return false;
}

struct Side {
  Vec2 from, to;
  Index start, end;  ///< vertices
};

bool in_box(const Side& s, const Vec2& p) {
  return (s.from.cwiseMin(s.to).array() <= p.array()).all() &&
         (p.array() <= s.from.cwiseMax(s.to).array()).all();
}

/// Whether two closed segments share a point.
bool touch(const Side& s, const Side& t) {
  const int a = orientation(s.from, s.to, t.from), b = orientation(s.from, s.to, t.to);
  const int c = orientation(t.from, t.to, s.from), d = orientation(t.from, t.to, s.to);
  if (a * b < 0 && c * d < 0) return true;
  return (a == 0 && in_box(s, t.from)) || (b == 0 && in_box(s, t.to)) ||
         (c == 0 && in_box(t, s.from)) || (d == 0 && in_box(t, s.to));
}

/// For sides that share the vertex where s ends and t starts: whether t runs back along s.
bool fold_back(const Side& s, const Side& t) {
  return orientation(s.from, s.to, t.to) == 0 && (s.from - s.to).dot(t.to - t.from) > 0;
}

bool clash(const Side& s, const Side& t) {
  if (s.end == t.start && t.end == s.start) return true;  // a loop of two sides
  if (s.end == t.start) return fold_back(s, t);
  if (t.end == s.start) return fold_back(t, s);
  return touch(s, t);
}

bool no_sides_clash(const std::vector<Side>& sides) {
  std::vector<Bounds> bounds(sides.size());
  for (std::size_t k = 0; k < sides.size(); ++k) {
    bounds[k].add(sides[k].from);
    bounds[k].add(sides[k].to);
  }
  const BoxTree tree(bounds);
  bool apart = true;
  for (std::size_t k = 0; k < sides.size() && apart; ++k)
    tree.query(bounds[k], [&](Index other) {
      if (static_cast<std::size_t>(other) > k && clash(sides[k], sides[other])) apart = false;
    });
  return apart;
}

/// The orientation of a simple polygon: that of the lowest of its leftmost corners.
int turn_of(const std::vector<Side>& loop) {
  std::size_t first = 0;
  for (std::size_t k = 1; k < loop.size(); ++k) {
    const Vec2 &p = loop[k].from, &q = loop[first].from;
    if (p.x() < q.x() || (p.x() == q.x() && p.y() < q.y())) first = k;
  }
  const Side& before = loop[(first + loop.size() - 1) % loop.size()];
  return orientation(before.from, loop[first].from, loop[first].to);
}

/// The overlapping pairs within `among`, which ascends.
std::vector<std::array<Index, 2>> pairs_among(const std::vector<Index>& among,
                                              std::span<const Triangle> faces,
                                              std::span<const Vec2> uv, std::size_t most,
                                              const std::stop_token& stop) {
  std::vector<Bounds> bounds(among.size());
  for (std::size_t k = 0; k < among.size(); ++k)
    for (const Vec2& p : corners(faces[among[k]], uv)) bounds[k].add(p);
  throw_if_cancelled(stop);
  const BoxTree tree(bounds);
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t k = 0; k < among.size() && pairs.size() < most; ++k) {
    if (k % kStepsBetweenLooks == 0) throw_if_cancelled(stop);
    const std::size_t first = pairs.size();
    tree.query(bounds[k], [&](Index other) {
      if (static_cast<std::size_t>(other) > k &&
          overlap(corners(faces[among[k]], uv), corners(faces[among[other]], uv)))
        pairs.push_back({among[k], among[other]});
    });
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end());
  }
  pairs.resize(std::min(pairs.size(), most));
  return pairs;
}

}  // namespace

bool overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  const int turn_a = orientation(a[0], a[1], a[2]), turn_b = orientation(b[0], b[1], b[2]);
  if (turn_a == 0 || turn_b == 0) return false;
  const std::array<Vec2, 3> left_a = turn_a > 0 ? a : std::array{a[0], a[2], a[1]};
  const std::array<Vec2, 3> left_b = turn_b > 0 ? b : std::array{b[0], b[2], b[1]};
  return !a_side_separates(left_a, left_b) && !a_side_separates(left_b, left_a);
}

bool is_plainly_injective(std::span<const Triangle> faces, std::span<const BoundaryLoop> loops,
                          std::span<const Vec2> uv, const std::stop_token& stop) {
  if (!flipped_faces(faces, uv, stop).empty()) return false;
  std::vector<Side> sides;
  int outer = 0;
  for (const BoundaryLoop& loop : loops) {
    std::vector<Side> own;
    for (Index h : loop) {
      const Index a = start_of(faces, h), b = end_of(faces, h);
      own.push_back({uv[a], uv[b], a, b});
    }
    outer += turn_of(own) > 0 ? 1 : 0;
    sides.insert(sides.end(), own.begin(), own.end());
  }
  return outer == 1 && no_sides_clash(sides);
}

std::vector<std::array<Index, 2>> overlapping_pairs(std::span<const Triangle> faces,
                                                    std::span<const Vec2> uv, std::size_t most,
                                                    const std::stop_token& stop) {
  std::vector<Index> all(faces.size());
  std::iota(all.begin(), all.end(), 0);
  return pairs_among(all, faces, uv, most, stop);
}

std::vector<std::array<Index, 2>> overlapping_pairs(std::span<const Triangle> faces,
                                                    std::span<const BoundaryLoop> loops,
                                                    std::span<const Vec2> uv, std::size_t most,
                                                    const std::stop_token& stop) {
  if (!flipped_faces(faces, uv, stop).empty()) return overlapping_pairs(faces, uv, most, stop);
  return pairs_among(faces_perhaps_overlapped(faces, loops, uv, stop), faces, uv, most, stop);
}

}  // namespace unwrapd::measure
