#pragma once
// How much of the plane a map covers more than once, and where its boundary would have to go.

#include <span>
#include <vector>

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::repair {

/// The area that is covered twice, for a map without flips: what k sheets cover counts k (k - 1) /
/// 2 times. The boundary is moved outwards first, so that the area is 0 only if there is a gap.
class OverlapArea {
 public:
  /// rank: the place of each vertex in the maps to come; gap: how far the boundary is moved.
  OverlapArea(const Disk& disk, std::span<const Index> rank, double gap);

  /// The area; adds -weight times its gradient to the force. Both spans: one a vertex, by rank.
  double evaluate(std::span<const Vec2> uv, double weight, std::span<Vec2> force);

 private:
  struct Side {
    std::size_t from, to;  ///< corners, see vertex_
  };

  void place_corners(std::span<const Vec2> uv);
  void sort_sides();
  void find_crossings(std::size_t side);
  [[nodiscard]] int sheets_beyond(std::size_t side, double at) const;
  [[nodiscard]] std::size_t row_of(double y) const;
  [[nodiscard]] Vec2 point(std::size_t side, double at) const;

  double gap_;
  std::vector<Index> vertex_;        ///< of the boundary, loop by loop: the corners
  std::vector<Side> side_;           ///< by their first corner
  std::vector<std::size_t> before_;  ///< the corner before each
  std::vector<Vec2> corner_;         ///< where they lie, moved outwards
  double low_ = 0, rows_per_unit_ = 0;
  std::vector<std::size_t> begin_, in_row_;  ///< sides by the rows that they meet
  std::vector<double> crossing_;             ///< of the side at hand with others, 0 and 1 included
};

}  // namespace unwrapd::solve::repair
