// A grid over the map. A cell that no boundary side comes near has one winding number: that of the
// cell to the left plus the sides that cross the row in between. Row and column are monotone
// functions of the coordinates, so that a side lies within the cells that its ends span, however
// coordinates are rounded: the numbers are exact.
//
// Rejected: a flood from faces of known number. Floods must not cross the boundary either, and are
// many if the boundary is ragged.
#include "core/measure/winding.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::measure {
namespace {

constexpr double kMostCells = 2048;  // a side

/// Column and row.
using Cell = std::array<int, 2>;

struct CellBox {
  Cell low, high;  ///< high: inclusive
};

/// A number for each cell, and for one more row and column.
class CellSums {
 public:
  explicit CellSums(int side)
      : stride_(static_cast<std::size_t>(side) + 1), number_(stride_ * stride_, 0) {}

  int& at(int column, int row) {
    return number_[static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column)];
  }
  [[nodiscard]] int get(int column, int row) const {
    if (column < 0 || row < 0) return 0;
    return number_[static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column)];
  }

  /// Replaces each by the sum over all cells to its left and below, itself included.
  void sum_up() {
    const auto side = static_cast<int>(stride_);
    for (int row = 0; row < side; ++row)
      for (int column = 0, in_row = 0; column < side; ++column) {
        in_row += at(column, row);
        at(column, row) = in_row + get(column, row - 1);
      }
  }

  /// Replaces positive entries by 1, so that sums over many cells stay small.
  void mark_positive() {
    for (int& number : number_) number = number > 0 ? 1 : 0;
  }

  /// Valid after sum_up().
  [[nodiscard]] int sum_in(const CellBox& box) const {
    return get(box.high[0], box.high[1]) - get(box.low[0] - 1, box.high[1]) -
           get(box.high[0], box.low[1] - 1) + get(box.low[0] - 1, box.low[1] - 1);
  }

 private:
  std::size_t stride_;
  std::vector<int> number_;
};

class WindingGrid {
 public:
  WindingGrid(std::span<const Vec2> uv, std::size_t face_count)
      : side_(static_cast<int>(std::min(kMostCells, 1 + std::sqrt(double(face_count))))),
        near_(side_),
        winding_(side_) {
    Vec2 high = low_ = uv.front();
    for (const Vec2& u : uv) low_ = low_.cwiseMin(u), high = high.cwiseMax(u);
    cells_per_unit_ = Vec2::Constant(side_).cwiseQuotient(high - low_);
  }

  void add_side(const Vec2& from, const Vec2& to) {
    const Cell a = cell_of(from), b = cell_of(to);
    const CellBox box = box_of({a, b});
    ++near_.at(box.low[0], box.low[1]);
    --near_.at(box.high[0] + 1, box.low[1]);
    --near_.at(box.low[0], box.high[1] + 1);
    ++near_.at(box.high[0] + 1, box.high[1] + 1);
    if (a[1] == b[1]) return;
    const int turn = a[1] > b[1] ? 1 : -1;  // downwards on the left is counter-clockwise
    winding_.at(box.low[0], box.low[1] + 1) += turn;
    winding_.at(box.low[0], box.high[1] + 1) -= turn;
  }

  /// Must be called once, after the last side and before the first query.
  void sum_up() {
    near_.sum_up();
    near_.mark_positive();
    near_.sum_up();
    winding_.sum_up();
  }

  /// Whether the boundary winds around all of the triangle once.
  [[nodiscard]] bool winds_once(const std::array<Vec2, 3>& corner) const {
    const CellBox box = box_of({cell_of(corner[0]), cell_of(corner[1]), cell_of(corner[2])});
    return near_.sum_in(box) == 0 && winding_.get(box.low[0], box.low[1]) == 1;
  }

 private:
  [[nodiscard]] Cell cell_of(const Vec2& p) const {
    const Vec2 at = (p - low_).cwiseProduct(cells_per_unit_);
    const auto index = [&](double x) { return static_cast<int>(std::min(x, side_ - 1.0)); };
    return {index(at.x()), index(at.y())};
  }

  static CellBox box_of(std::initializer_list<Cell> cells) {
    CellBox box{*cells.begin(), *cells.begin()};
    for (const Cell& cell : cells)
      for (std::size_t k : {0U, 1U}) {
        box.low[k] = std::min(box.low[k], cell[k]);
        box.high[k] = std::max(box.high[k], cell[k]);
      }
    return box;
  }

  int side_;
  Vec2 low_, cells_per_unit_;
  CellSums near_;     ///< cells near a boundary side
  CellSums winding_;  ///< differences to the left and below, until sum_up()
};

}  // namespace

std::vector<Index> faces_perhaps_overlapped(std::span<const Triangle> faces,
                                            std::span<const BoundaryLoop> loops,
                                            std::span<const Vec2> uv, const std::stop_token& stop) {
  if (faces.empty()) return {};
  WindingGrid grid(uv, faces.size());
  for (const BoundaryLoop& loop : loops)
    for (const Index h : loop) grid.add_side(uv[start_of(faces, h)], uv[end_of(faces, h)]);
  throw_if_cancelled(stop);
  grid.sum_up();
  std::vector<Index> perhaps;
  for (std::size_t t = 0; t < faces.size(); ++t) {
    check_cancelled_every(t, stop);
    const auto& [a, b, c] = faces[t];
    if (!grid.winds_once({uv[a], uv[b], uv[c]})) perhaps.push_back(static_cast<Index>(t));
  }
  return perhaps;
}

}  // namespace unwrapd::measure
