#pragma once
// A search tree for points in space.

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// A k-d tree (Bentley 1975) over some of the points of a list.
class PointTree {
 public:
  /// points must outlive the tree; of: the indices of its points, ascending. Positions are finite.
  PointTree(std::span<const Vec3> points, std::vector<Index> of);

  /// The point nearest to a place, the lowest of equally near ones; empty if there is none.
  [[nodiscard]] std::optional<Index> nearest(const Vec3& place) const;

  /// The points no further than radius from a place, but no more than `most`: the nearest ones, in
  /// ascending distance, the lowest first of equally near ones.
  [[nodiscard]] std::vector<Index> nearest_within(const Vec3& place, double radius,
                                                  std::size_t most) const;

  /// All points at exactly this place, ascending.
  [[nodiscard]] std::vector<Index> at(const Vec3& place) const;

 private:
  struct Range {
    std::size_t first, last;
    [[nodiscard]] std::size_t middle() const { return first + (last - first) / 2; }
  };
  struct Box {
    Vec3 low, high;
    [[nodiscard]] double distance2(const Vec3& place) const {
      return (place - place.cwiseMax(low).cwiseMin(high)).squaredNorm();
    }
  };
  struct Nearest {
    Index point = 0;
    double distance2 = std::numeric_limits<double>::infinity();
    bool operator<(const Nearest& other) const {
      return distance2 != other.distance2 ? distance2 < other.distance2 : point < other.point;
    }
  };

  [[nodiscard]] const Vec3& point(std::size_t node) const;
  void build(Range range);
  [[nodiscard]] double distance2(Range range, const Vec3& place) const;
  void search(Range range, const Vec3& place, Nearest& best) const;
  void collect(Range range, const Vec3& place, std::vector<Index>& found) const;
  struct Nearby;  // the best so far, of a search for several
  void search(Range range, const Vec3& place, Nearby& best) const;

  std::span<const Vec3> points_;
  std::vector<Index> of_;  // the middle of a range divides it
  std::vector<Box> box_;   // of the range that the point divides
};

}  // namespace unwrapd
