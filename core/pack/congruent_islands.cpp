// Two outlines of equal length and number of corners are aligned by the best rotation (Kabsch 1976,
// in the plane: the argument of a complex sum) for every first corner of the second outline.
// Islands are sorted by length first, so that only similar ones are compared.
#include "core/pack/congruent_islands.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "core/base/cancel.hpp"

namespace unwrapd::pack {
namespace {

using Point = std::complex<double>;
using Loop = std::vector<Point>;

constexpr double kTolerance = 1e-4;  // of the extent

struct Shape {
  std::vector<Loop> loops;  ///< each starts where the outline starts it
  double length = 0;
};

Shape shape_of(const charts::Outline& outline) {
  Shape shape;
  const Vec2* end = nullptr;
  for (const auto& [a, b] : outline) {
    if (end == nullptr || *end != a) shape.loops.emplace_back();
    shape.loops.back().emplace_back(a.x(), a.y());
    shape.length += (b - a).norm();
    end = &b;
  }
  return shape;
}

Point middle(const Loop& loop) {
  return std::accumulate(loop.begin(), loop.end(), Point()) / static_cast<double>(loop.size());
}

struct Motion {
  Point turn = 1, move = 0;

  Point operator()(const Point& p) const { return turn * p + move; }
};

/// The best motion of one loop onto the other; corner k + shift of `to` corresponds to corner k of
/// `from`.
Motion motion_onto(const Loop& from, const Loop& to, std::size_t shift, Rotation rotation) {
  const Point a = middle(from), b = middle(to);
  if (rotation == Rotation::none) return {1, b - a};
  Point sum = 0;
  for (std::size_t k = 0; k < from.size(); ++k)
    sum += std::conj(from[k] - a) * (to[(k + shift) % to.size()] - b);
  const double size = std::abs(sum);
  const Point turn = size > 0 ? sum / size : Point(1);
  return {turn, b - turn * a};
}

bool lies_on(const Loop& from, const Loop& to, std::size_t shift, const Motion& motion,
             double tolerance) {
  for (std::size_t k = 0; k < from.size(); ++k)
    if (std::abs(motion(from[k]) - to[(k + shift) % to.size()]) > tolerance) return false;
  return true;
}

bool lies_on(const Loop& from, const Loop& to, const Motion& motion, double tolerance) {
  for (std::size_t shift = 0; shift < to.size(); ++shift)
    if (lies_on(from, to, shift, motion, tolerance)) return true;
  return false;
}

/// Sets motion and returns true if it takes all loops of `from` to those of `to`.
bool match(const Shape& from, const Shape& to, Rotation rotation, Motion& motion) {
  const double tolerance = kTolerance * to.length / 4;
  const auto equal_size = [](const Loop& a, const Loop& b) { return a.size() == b.size(); };
  if (!std::equal(from.loops.begin(), from.loops.end(), to.loops.begin(), to.loops.end(),
                  equal_size))
    return false;
  const auto others_lie = [&] {
    for (std::size_t k = 1; k < to.loops.size(); ++k)
      if (!lies_on(from.loops[k], to.loops[k], motion, tolerance)) return false;
    return true;
  };
  for (std::size_t shift = 0; shift < to.loops[0].size(); ++shift) {
    motion = motion_onto(from.loops[0], to.loops[0], shift, rotation);
    if (lies_on(from.loops[0], to.loops[0], shift, motion, tolerance) && others_lie()) return true;
  }
  return false;
}

}  // namespace

std::vector<CongruentIsland> congruent_islands(std::span<const charts::Outline> islands,
                                               Rotation rotation, const std::stop_token& stop) {
  std::vector<Shape> shapes;
  shapes.reserve(islands.size());
  for (const charts::Outline& island : islands) shapes.push_back(shape_of(island));
  std::vector<std::size_t> order(islands.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return shapes[a].length < shapes[b].length;
  });
  std::vector<CongruentIsland> same(islands.size());
  std::vector<std::size_t> firsts;  // of their shapes, in ascending length
  for (const std::size_t k : order) {
    throw_if_cancelled(stop);
    same[k].as = static_cast<Index>(k);
    for (auto first = firsts.rbegin(); first != firsts.rend(); ++first) {
      if (shapes[*first].length < (1 - kTolerance) * shapes[k].length) break;
      Motion motion;
      if (!match(shapes[k], shapes[*first], rotation, motion)) continue;
      same[k] = {static_cast<Index>(*first),
                 motion.turn.real(),
                 motion.turn.imag(),
                 {motion.move.real(), motion.move.imag()}};
      break;
    }
    if (same[k].as == static_cast<Index>(k)) firsts.push_back(k);
  }
  return same;
}

}  // namespace unwrapd::pack
