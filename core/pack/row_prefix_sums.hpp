#pragma once
// The weighted overlap of a mask with taken cells, for any of its places.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/pack/mask.hpp"

namespace unwrapd::pack {

/// The number of cells in both rows; shift is added to those of b.
int common_cells(std::span<const Run> a, std::span<const Run> b, int shift);

/// Cells [x_begin, x_end) x [y_begin, y_end).
struct CellWindow {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Of a column of places.
struct LeastOverlap {
  int y = 0;
  std::int32_t weight = 0;
};

/// Weighted cells of a window, in each row summed up from the left: what a run covers is the
/// difference of two entries. Columns lie in one piece, so a register has many places of one.
class RowPrefixSums {
 public:
  static constexpr std::int32_t kTooMuch = 1 << 29;

  /// Removes all cells.
  void reset(const CellWindow& window);

  /// Adds weight to the cells of an island whose lower left cell is (x, y). Cells outside of the
  /// window are ignored.
  void take(const Rows& touched, int x, int y, std::int32_t weight);

  /// Must be called once between take() and overlap().
  void sum_up();

  /// The lowest place of least weight of the mask in column x, from y_begin to y_last. The weight
  /// is kTooMuch if no place weighs less than most (at most kTooMuch). mask.grown must lie inside
  /// the window at all these places.
  [[nodiscard]] LeastOverlap least(const Mask& mask, int x, int y_begin, int y_last,
                                   std::int32_t most);

  [[nodiscard]] std::int64_t work() const { return work_; }  ///< in units of about a nanosecond

 private:
  [[nodiscard]] std::int32_t* column(int x) {
    return table_.data() + static_cast<std::size_t>(x - window_.x_begin) * stride_;
  }

  CellWindow window_;
  std::size_t stride_ = 0;
  std::int64_t work_ = 0;
  std::vector<std::int32_t> table_;
};

}  // namespace unwrapd::pack
