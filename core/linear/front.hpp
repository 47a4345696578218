#pragma once
// One dense front of the multifrontal method: the pivot columns of a supernode, plus the
// contributions of its children and the matrix, and the update that it passes to its parent.

#include <cstddef>

#include "core/base/executor.hpp"
#include "core/linear/front_panel.hpp"
#include "core/linear/large_array.hpp"

namespace unwrapd::linear {

/// Memory that grows and is never cleared.
class Scratch {
 public:
  /// Memory for n numbers; earlier contents are lost.
  double* room(std::size_t n) {
    if (n > size_) memory_ = large_array(size_ = n + n / 2);
    return memory_.get();
  }

 private:
  LargeArray memory_;
  std::size_t size_ = 0;
};

/// The memory layout of a front. The rows below the pivots start at a whole pack, update_begin();
/// rows between are zero.
struct FrontView {
  PanelShape shape{};
  std::size_t stride = 0;     ///< rows of a column, padded
  double* columns = nullptr;  ///< lower triangle of the symmetric matrix
  double* strips = nullptr;   ///< a copy of the pivot columns, see front_kernels.hpp
  double* inverse = nullptr;  ///< kPack columns of L11^-1, by rows

  [[nodiscard]] std::size_t update_begin() const { return padded(shape.pivots, kPack); }
  [[nodiscard]] std::size_t size() const { return update_begin() + shape.below; }
};

class Front {
 public:
  /// Sets all numbers to zero.
  void reset(PanelShape shape);

  /// The address of row j of column j; the rows below it follow.
  [[nodiscard]] double* diagonal(std::size_t j) { return view_.columns + j * (view_.stride + 1); }
  [[nodiscard]] std::size_t update_begin() const { return view_.update_begin(); }

  /// Turns the pivot columns into those of the Cholesky factor, subtracts their products from the
  /// rest, which is then the update, and writes the panel (shape.size() numbers). Returns false if
  /// a pivot is not positive and finite. The same bits on any processor.
  [[nodiscard]] bool factor(double* panel) const;

  /// The same bits for any executor, whose threads share large fronts. Throws Error{cancelled}.
  [[nodiscard]] bool factor(double* panel, Executor& executor) const;

  /// The same with the registers of the x86-64 baseline, for comparison.
  [[nodiscard]] bool factor_on_baseline(double* panel) const;

 private:
  FrontView view_;
  Scratch columns_, strips_, inverse_;
};

}  // namespace unwrapd::linear
