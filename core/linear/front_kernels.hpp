#pragma once
// A right-looking Cholesky in blocks of columns. All work of the third order goes through one
// kernel, multiply(): a strip of eight rows times four columns, sums in registers, both factors
// read from `strips`, a copy of the pivot columns in which the eight rows of a strip lie side by
// side (strip by strip, within it column by column). Rejected: BLAS, whose calls cost more than
// most of these fronts.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/linear/front.hpp"

namespace unwrapd::linear {

inline constexpr std::size_t kStrip = 8;   ///< rows
inline constexpr std::size_t kBlock = 64;  ///< columns factored before the rest is updated

/// Columns begin .. end-1 of a front.
struct Columns {
  std::size_t begin, end;
};

/// Lanes: the vector of doubles of one register. Everything is inlined into the one function that
/// is compiled for the processor with such registers. No result depends on their length.
template <typename Lanes>
class FrontKernels {
 public:
  [[gnu::always_inline]] explicit FrontKernels(const FrontView& front) : f_(front) {}

  /// Factors columns begin .. end-1. False on a bad pivot.
  [[gnu::always_inline]] bool finish(Columns own) const {
    if (!factor_block(own.begin, own.end)) return false;
    pack(own.begin, own.end);
    return true;
  }

  /// Subtracts the products of finished columns from others, which start at a pack. Values above
  /// the diagonal are never read.
  [[gnu::always_inline]] void update(Columns finished, Columns others) const {
    Tile<kStrip> tile;
    for (std::size_t j = others.begin; j < others.end; j += kPack) {
      const Weights weights{strip(j) + finished.begin * kStrip, kStrip};
      for (std::size_t row = j / kStrip * kStrip; row < f_.stride; row += kStrip) {
        multiply(strip(row) + finished.begin * kStrip, weights, finished.end - finished.begin,
                 tile);
        for (std::size_t c = 0; c < kPack; ++c)
          for (std::size_t r = 0; r < kStrip; r += kLanes)
            lanes(f_.columns + (j + c) * f_.stride + row + r) -= lanes(tile.column[c] + r);
      }
    }
  }

  /// Writes the panel's part of these columns, which start at a pack.
  [[gnu::always_inline]] void write_panel(Columns own, double* panel) const {
    for (std::size_t column = own.begin; column < own.end; column += kPack) {
      invert(column);
      write_inverse(column, panel);
      write_below(column, panel);
    }
  }

 private:
  static constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(double);

  /// kRows rows of a strip, kPack columns.
  template <std::size_t kRows>
  struct Tile {
    double column[kPack][kRows];
  };

  /// A matrix of kPack columns: entry (k, c) at entry[k * stride + c].
  struct Weights {
    const double* entry;
    std::size_t stride;
  };

  [[gnu::always_inline]] static const Lanes& lanes(const double* x) {
    return *reinterpret_cast<const Lanes*>(x);
  }
  [[gnu::always_inline]] static Lanes& lanes(double* x) { return *reinterpret_cast<Lanes*>(x); }

  [[gnu::always_inline]] double* strip(std::size_t row) const {
    return f_.strips + row / kStrip * kStrip * f_.shape.pivots + row % kStrip;
  }

  /// sum[c] += weight[c] * rows, for the rows that kCount registers hold.
  template <std::size_t kCount>
  [[gnu::always_inline]] static void add_product(const double* rows, const double* weight,
                                                 Lanes (&sum)[kPack][kCount]) {
    for (std::size_t c = 0; c < kPack; ++c)
      for (std::size_t p = 0; p < kCount; ++p) sum[c][p] += lanes(rows + p * kLanes) * weight[c];
  }

  /// tile = rows * columns, over `depth` products.
  template <std::size_t kRows>
  [[gnu::always_inline]] static void multiply(const double* rows, Weights columns,
                                              std::size_t depth, Tile<kRows>& tile) {
    constexpr std::size_t count = std::min<std::size_t>(2, kRows / kLanes);
    for (std::size_t r = 0; r < kRows; r += count * kLanes) {
      Lanes sum[kPack][count] = {};
      for (std::size_t k = 0; k < depth; ++k)
        add_product(rows + k * kStrip + r, columns.entry + k * columns.stride, sum);
      for (std::size_t c = 0; c < kPack; ++c)
        for (std::size_t p = 0; p < count; ++p) lanes(tile.column[c] + r + p * kLanes) = sum[c][p];
    }
  }

  /// Factors columns begin .. end-1, all rows.
  [[gnu::always_inline]] bool factor_block(std::size_t begin, std::size_t end) const {
    for (std::size_t k = begin; k < end; k += kPack) {
      const std::size_t next = std::min(k + kPack, end);
      for (std::size_t j = k; j < next; ++j)
        if (!factor_column(j, next)) return false;
      for (std::size_t j = next; j < end; ++j) subtract_four(k, j);
    }
    return true;
  }

  /// Factors column k and subtracts its products from the columns k+1 .. end-1.
  [[gnu::always_inline]] bool factor_column(std::size_t k, std::size_t end) const {
    double* own = f_.columns + k * f_.stride;
    const double pivot = own[k];
    if (!(pivot > 0 && pivot < std::numeric_limits<double>::infinity())) return false;
    const double scale = 1 / std::sqrt(pivot);
    const std::size_t from = k / kPack * kPack;
    for (std::size_t r = from; r < f_.stride; r += kLanes) lanes(own + r) *= scale;
    for (std::size_t j = k + 1; j < end; ++j) {
      double* to = own + (j - k) * f_.stride;
      const double weight = own[j];
      for (std::size_t r = from; r < f_.stride; r += kLanes)
        lanes(to + r) -= lanes(own + r) * weight;
    }
    return true;
  }

  /// Subtracts the products of columns k .. k+3 from column j.
  [[gnu::always_inline]] void subtract_four(std::size_t k, std::size_t j) const {
    const double* a = f_.columns + k * f_.stride;
    const double *b = a + f_.stride, *c = b + f_.stride, *d = c + f_.stride;
    double* to = f_.columns + j * f_.stride;
    for (std::size_t r = j / kPack * kPack; r < f_.stride; r += kLanes)
      lanes(to + r) -=
          lanes(a + r) * a[j] + lanes(b + r) * b[j] + lanes(c + r) * c[j] + lanes(d + r) * d[j];
  }

  [[gnu::always_inline]] void pack(std::size_t begin, std::size_t end) const {
    for (std::size_t row = begin / kStrip * kStrip; row < f_.stride; row += kStrip)
      for (std::size_t k = begin; k < end; ++k)
        std::memcpy(strip(row) + k * kStrip, f_.columns + k * f_.stride + row,
                    kStrip * sizeof(double));
  }

  /// The block of columns of L11^-1 that starts at `column`, by substitution from the diagonal
  /// down.
  [[gnu::always_inline]] void invert(std::size_t column) const {
    for (std::size_t row = column; row < f_.update_begin(); row += kPack) {
      Tile<kPack> known;
      multiply(strip(row) + column * kStrip, {f_.inverse + column * kPack, kPack}, row - column,
               known);
      for (std::size_t i = row; i < row + kPack; ++i) {
        double* to = f_.inverse + i * kPack;
        for (std::size_t c = 0; c < kPack; ++c) to[c] = -known.column[c][i - row];
        if (i < f_.shape.pivots) substitute(i, row, column);
      }
    }
  }

  /// Row i, less what the rows from `row` on contribute, over the diagonal.
  [[gnu::always_inline]] void substitute(std::size_t i, std::size_t row, std::size_t column) const {
    double* to = f_.inverse + i * kPack;
    const double* factor = strip(i);
    if (i - column < kPack) to[i - column] += 1;
    for (std::size_t c = 0; c < kPack; c += kLanes) {
      for (std::size_t m = row; m < i; ++m)
        lanes(to + c) -= lanes(f_.inverse + m * kPack + c) * factor[m * kStrip];
      lanes(to + c) /= factor[i * kStrip];
    }
  }

  [[gnu::always_inline]] void write_inverse(std::size_t column, double* panel) const {
    const std::size_t end = f_.shape.pivots + f_.shape.below;
    for (std::size_t c = 0; c < f_.shape.width(column); ++c) {
      for (std::size_t row = column; row < f_.shape.pivots; ++row)
        panel[f_.shape.entry(row, column, c)] = f_.inverse[row * kPack + c];
      for (std::size_t row = end; row < f_.shape.height(); ++row)
        panel[f_.shape.entry(row, column, c)] = 0;
    }
  }

  /// L21 L11^-1 of one block of columns.
  [[gnu::always_inline]] void write_below(std::size_t column, double* panel) const {
    const std::size_t shift = f_.update_begin() - f_.shape.pivots;
    Tile<kStrip> tile;
    for (std::size_t row = f_.update_begin() / kStrip * kStrip; row < f_.size(); row += kStrip) {
      multiply(strip(row) + column * kStrip, {f_.inverse + column * kPack, kPack},
               f_.shape.pivots - column, tile);
      const std::size_t begin = std::max(row, f_.update_begin());
      const std::size_t end = std::min(row + kStrip, f_.size());
      for (std::size_t r = begin; r < end; ++r)
        for (std::size_t c = 0; c < f_.shape.width(column); ++c)
          panel[f_.shape.entry(r - shift, column, c)] = tile.column[c][r - row];
    }
  }

  FrontView f_;
};

}  // namespace unwrapd::linear
