// A range of the array is a subtree. Its middle element divides it along the widest axis, lower
// elements come first, and equal points are ordered by number, so that the depth is log2 of the
// size for all inputs. A subtree is skipped if its box is too far away, not only its dividing
// plane: for a place far from a surface, planes alone skip almost nothing.
#include "core/mesh/point_tree.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd {

struct PointTree::Nearby {
  double radius2;
  std::size_t most;
  std::vector<Nearest> list = {};  // ascending

  [[nodiscard]] double reach2() const {
    return list.size() < most ? radius2 : list.back().distance2;
  }
  void add(const Nearest& found) {
    if (found.distance2 > radius2) return;
    list.insert(std::upper_bound(list.begin(), list.end(), found), found);
    if (list.size() > most) list.pop_back();
  }
};

PointTree::PointTree(std::span<const Vec3> points, std::vector<Index> of)
    : points_(points), of_(std::move(of)), box_(of_.size()) {
  build({0, of_.size()});
}

const Vec3& PointTree::point(std::size_t node) const {
  return points_[static_cast<std::size_t>(of_[node])];
}

void PointTree::build(Range range) {
  if (range.first == range.last) return;
  Vec3 low = point(range.first), high = low;
  for (std::size_t k = range.first; k < range.last; ++k) {
    low = low.cwiseMin(point(k));
    high = high.cwiseMax(point(k));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto before = [&](Index a, Index b) {
    const double x = points_[static_cast<std::size_t>(a)][axis];
    const double y = points_[static_cast<std::size_t>(b)][axis];
    return x != y ? x < y : a < b;
  };
  const auto at = [&](std::size_t k) { return of_.begin() + static_cast<std::ptrdiff_t>(k); };
  const std::size_t middle = range.middle();
  std::nth_element(at(range.first), at(middle), at(range.last), before);
  box_[middle] = {low, high};
  build({range.first, middle});
  build({middle + 1, range.last});
}

double PointTree::distance2(Range range, const Vec3& place) const {
  if (range.first == range.last) return std::numeric_limits<double>::infinity();
  return box_[range.middle()].distance2(place);
}

void PointTree::search(Range range, const Vec3& place, Nearest& best) const {
  const std::size_t middle = range.middle();
  const double d2 = (point(middle) - place).squaredNorm();
  if (d2 < best.distance2 || (d2 == best.distance2 && of_[middle] < best.point))
    best = {of_[middle], d2};
  Range near{range.first, middle}, far{middle + 1, range.last};
  double to_near = distance2(near, place), to_far = distance2(far, place);
  if (to_far < to_near) std::swap(near, far), std::swap(to_near, to_far);
  if (near.first < near.last && to_near <= best.distance2) search(near, place, best);
  if (far.first < far.last && to_far <= best.distance2) search(far, place, best);
}

void PointTree::search(Range range, const Vec3& place, Nearby& best) const {
  if (range.first == range.last || distance2(range, place) > best.reach2()) return;
  const std::size_t middle = range.middle();
  best.add({of_[middle], (point(middle) - place).squaredNorm()});
  Range near{range.first, middle}, far{middle + 1, range.last};
  if (distance2(far, place) < distance2(near, place)) std::swap(near, far);
  search(near, place, best);
  search(far, place, best);
}

void PointTree::collect(Range range, const Vec3& place, std::vector<Index>& found) const {
  if (distance2(range, place) > 0) return;
  const std::size_t middle = range.middle();
  if (point(middle) == place) found.push_back(of_[middle]);
  collect({range.first, middle}, place, found);
  collect({middle + 1, range.last}, place, found);
}

std::optional<Index> PointTree::nearest(const Vec3& place) const {
  if (of_.empty()) return std::nullopt;
  Nearest best{.point = of_.front()};  // if every distance overflows
  search({0, of_.size()}, place, best);
  return best.point;
}

std::vector<Index> PointTree::nearest_within(const Vec3& place, double radius,
                                             std::size_t most) const {
  Nearby best{radius * radius, most};
  search({0, of_.size()}, place, best);
  std::vector<Index> points;
  for (const Nearest& found : best.list) points.push_back(found.point);
  return points;
}

std::vector<Index> PointTree::at(const Vec3& place) const {
  std::vector<Index> found;
  collect({0, of_.size()}, place, found);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace unwrapd
