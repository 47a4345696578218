#pragma once
// How much of a mask lies on taken cells, for any place of it at once.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/pack/mask.hpp"

namespace unwrapd::pack {

/// How many cells lie in both rows; shift: added to those of b.
int common_cells(std::span<const Run> a, std::span<const Run> b, int shift);

/// Cells [x_begin, x_end) x [y_begin, y_end).
struct CellWindow {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Weighted cells of a window, in each row summed up from the left: what a run covers is the
/// difference of two entries. Columns lie in one piece, so a register has many places of one.
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

  /// Forgets what was taken.
  void reset(const CellWindow& window);

  /// Cells of an island whose lower left one lies on (x, y) get heavier. What lies outside of the
  /// window is left out.
  void take(const Rows& touched, int x, int y, std::int32_t weight);

  /// To be called once between take() and overlap().
  void sum_up();

  /// Where in the column x, from y_begin to y_last, the cells on or near to the mask weigh least,
  /// the lowest of such places; kTooMuch where none weighs less than most (at most kTooMuch). All
  /// of mask.grown lies in the window there.
  [[nodiscard]] LeastOverlap least(const Mask& mask, int x, int y_begin, int y_last,
                                   std::int32_t most);

  [[nodiscard]] std::int64_t work() const { return work_; }  ///< in steps of about a nanosecond

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
