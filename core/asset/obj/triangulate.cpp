// Ear clipping in the plane of the polygon's Newell normal.
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/pace.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/asset/obj/polygons.hpp"

namespace unwrapd::asset::obj {
namespace {

Vec3 newell_normal(std::span<const Vec3> polygon) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    normal += (polygon[i] - polygon[0]).cross(polygon[(i + 1) % polygon.size()] - polygon[0]);
  return normal;
}

/// The polygon's corners in the plane, turning left around it. A polygon without area lies on a
/// point, and has no ears.
std::vector<Vec2> flattened(std::span<const Vec3> polygon) {
  const Vec3 normal = newell_normal(polygon).stableNormalized();
  if (normal.isZero(0)) return std::vector<Vec2>(polygon.size(), Vec2::Zero());
  const Vec3 right = normal.unitOrthogonal(), up = normal.cross(right);
  std::vector<Vec2> points;
  points.reserve(polygon.size());
  for (const Vec3& p : polygon)
    points.emplace_back((p - polygon[0]).dot(right), (p - polygon[0]).dot(up));
  return points;
}

constexpr std::size_t kOneCell = 512;  // corners

/// Corners of a polygon in equal cells, about one to a cell; up to kOneCell corners in one.
class CornerGrid {
 public:
  CornerGrid(const std::vector<Vec2>& points, const std::vector<Index>& corners)
      : points_(points), low_(points[0]), high_(points[0]), room_(corners.size()) {
    for (const Vec2& p : points) low_ = low_.cwiseMin(p), high_ = high_.cwiseMax(p);
    if (room_ > kOneCell) side_ = static_cast<int>(std::sqrt(double(room_)));
    cells_.resize(as_size(side_ * side_));
    for (const Index corner : corners) insert(corner);
  }

  void insert(Index corner) {
    cell_of(corner).push_back(corner);
    ++size_;
  }
  void erase(Index corner) {
    std::vector<Index>& cell = cell_of(corner);
    looks_ += cell.size();
    size_ -= std::erase(cell, corner);
  }

  /// The cells and corners looked at since the last call.
  std::size_t take_looks() { return std::exchange(looks_, 0); }

  /// Whether most cells are empty and a grid of fewer would do.
  [[nodiscard]] bool is_sparse() const { return side_ > 1 && size_ < room_ / 2; }

  /// Whether `is` holds for a corner in a cell that meets the triangle's bounding box.
  template <typename Predicate>
  bool any_near(const Vec2& a, const Vec2& b, const Vec2& c, const Predicate& is) {
    const Vec2 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    for (int y = row(low.y()); y <= row(high.y()); ++y)
      for (int x = column(low.x()); x <= column(high.x()); ++x) {
        const std::vector<Index>& cell = cells_[as_size(y * side_ + x)];
        looks_ += 1 + cell.size();
        if (std::any_of(cell.begin(), cell.end(), is)) return true;
      }
    return false;
  }

 private:
  [[nodiscard]] int place(double x, double low, double high) const {
    const double at = high > low ? (x - low) / (high - low) * side_ : 0;
    return at > 0 ? static_cast<int>(std::min(at, side_ - 1.0)) : 0;
  }
  [[nodiscard]] int column(double x) const { return place(x, low_.x(), high_.x()); }
  [[nodiscard]] int row(double y) const { return place(y, low_.y(), high_.y()); }
  std::vector<Index>& cell_of(Index corner) {
    const Vec2& p = points_[as_size(corner)];
    return cells_[as_size(row(p.y()) * side_ + column(p.x()))];
  }

  const std::vector<Vec2>& points_;
  Vec2 low_, high_;
  std::size_t room_, size_ = 0;  ///< corners: at first, and now
  std::size_t looks_ = 0;
  int side_ = 1;  ///< cells
  std::vector<std::vector<Index>> cells_;
};

/// Cuts ears off: corners that turn left and whose triangle no corner lies in that turns right.
/// (Meisters, Polygons have ears, 1975.) A cut changes what its two neighbours are and nothing
/// else.
class EarClipper {
 public:
  EarClipper(std::span<const Vec3> polygon, Pace& pace)
      : points_(flattened(polygon)),
        pace_(pace),
        looks_left_(kLooks * polygon.size()),
        next_(polygon.size()),
        previous_(polygon.size()),
        turns_left_(polygon.size(), 0) {
    const auto n = static_cast<Index>(polygon.size());
    for (Index i = 0; i < n; ++i) next_[as_size(i)] = (i + 1) % n;
    for (Index i = 0; i < n; ++i) previous_[as_size(i)] = (i + n - 1) % n;
    for (Index i = 0; i < n; ++i) turns_left_[as_size(i)] = is_left_turn(i);
    make_grid();
    for (Index i = 0; i < n; ++i) look_at_ear(i);
  }

  void clip(std::vector<std::array<Index, 3>>& triangles) {
    for (std::size_t left = points_.size(); left > 3; --left) {
      const Index ear = looks_left_ > 0 ? find_ear() : next(first_);
      triangles.push_back({previous(ear), ear, next(ear)});
      cut(ear);
    }
    triangles.push_back({first_, next(first_), previous(first_)});
  }

 private:
  /// Corners looked at for each of the polygon: as many as a polygon of one cell can need. A longer
  /// one that needs more, and so time that grows as its square, ends as a fan.
  static constexpr std::size_t kLooks = 4 * (kOneCell + 1);

  [[nodiscard]] const Vec2& at(Index corner) const { return points_[as_size(corner)]; }
  [[nodiscard]] Index next(Index corner) const { return next_[as_size(corner)]; }
  [[nodiscard]] Index previous(Index corner) const { return previous_[as_size(corner)]; }
  [[nodiscard]] bool turns_left(Index corner) const { return turns_left_[as_size(corner)] != 0; }

  [[nodiscard]] char is_left_turn(Index i) const {
    return turn(at(previous(i)), at(i), at(next(i))) > 0 ? 1 : 0;
  }

  void make_grid() {
    std::vector<Index> corners;
    Index corner = first_;
    do {
      if (!turns_left(corner)) corners.push_back(corner);
      corner = next(corner);
    } while (corner != first_);
    pace_.add(points_.size());
    others_.emplace(points_, corners);
  }

  void look_at_turn(Index i) {
    const char before = std::exchange(turns_left_[as_size(i)], is_left_turn(i));
    if (before == turns_left_[as_size(i)]) return;
    if (before == 0)
      others_->erase(i);
    else
      others_->insert(i);
  }

  void look_at_ear(Index i) {
    if (turns_left(i) && !contains_a_corner(previous(i), i, next(i)))
      ears_.insert(i);
    else
      ears_.erase(i);
  }

  /// Where a corner lies in the triangle, so does one that turns right.
  [[nodiscard]] bool contains_a_corner(Index i, Index j, Index k) {
    const Vec2 &a = at(i), &b = at(j), &c = at(k);
    const bool contains = others_->any_near(a, b, c, [&](Index other) {
      if (other == i || other == k) return false;
      const Vec2& p = at(other);
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
    });
    const std::size_t looks = others_->take_looks();
    looks_left_ -= std::min(looks, looks_left_);
    pace_.add(looks / 4);
    return contains;
  }

  /// The second corner first, so that a convex polygon becomes a fan around its first. A long one
  /// is cut all around, since the triangles of a fan would meet most of its corners. A polygon that
  /// crosses itself may have no ear: any corner will do.
  [[nodiscard]] Index find_ear() const {
    const auto after = ears_.upper_bound(points_.size() > kOneCell ? last_cut_ : first_);
    if (after != ears_.end()) return *after;
    return ears_.empty() ? next(first_) : *ears_.begin();
  }

  void cut(Index ear) {
    const Index before = previous(ear), after = next(ear);
    next_[as_size(before)] = after;
    previous_[as_size(after)] = before;
    if (!turns_left(ear)) others_->erase(ear);
    ears_.erase(ear);
    if (ear == first_) first_ = after;
    last_cut_ = after;  // the ear beside it would have its longest side
    if (looks_left_ == 0) return;
    for (const Index i : {before, after}) look_at_turn(i);
    if (others_->is_sparse()) make_grid();
    for (const Index i : {before, after}) look_at_ear(i);
  }

  const std::vector<Vec2> points_;  ///< of all corners
  Pace& pace_;
  std::size_t looks_left_;
  Index first_ = 0, last_cut_ = 0;
  std::vector<Index> next_, previous_;  ///< [corner]: around what is left of the polygon
  std::vector<char> turns_left_;
  std::optional<CornerGrid> others_;  ///< corners that do not turn left
  std::set<Index> ears_;
};

}  // namespace

void triangulate(std::span<const Vec3> polygon, std::vector<std::array<Index, 3>>& triangles,
                 Pace& pace) {
  assert(polygon.size() >= 3);
  pace.add(polygon.size());
  if (polygon.size() == 3) {
    triangles.push_back({0, 1, 2});
  } else {
    EarClipper(polygon, pace).clip(triangles);
  }
}

}  // namespace unwrapd::asset::obj
