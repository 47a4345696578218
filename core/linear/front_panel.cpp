// Panels are read once in each direction, and memory bandwidth limits a solve. So blocks of four
// columns share every load and store of the vectors, and a register of four numbers holds two rows
// of both right-hand sides. The backward sweep reads memory in strictly descending order, from the
// end of the last panel to the start of the first: processors prefetch such a sequence as well as
// an ascending one, but not ascending panels in descending order (up to 2.5 times slower; prefetch
// instructions did not help).
#include "core/linear/front_panel.hpp"

namespace unwrapd::linear {
namespace {

/// Two numbers in one register of the x86-64 baseline; four in one of AVX2.
using Duo = double __attribute__((vector_size(16), aligned(8), may_alias));
using Quad = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Loads two numbers of a panel, for each right-hand side.
[[gnu::always_inline]] inline void spread(const double* from, Duo& to) {
  to = *reinterpret_cast<const Duo*>(from);
}
[[gnu::always_inline]] inline void spread(const double* from, Quad& to) {
  const Duo two = *reinterpret_cast<const Duo*>(from);
  to = __builtin_shufflevector(two, two, 0, 1, 0, 1);
}

struct PanelBaseline {
  using Lanes = Duo;
};
struct PanelAvx2 {
  using Lanes = Quad;
};

/// Registers::Lanes: the vector of doubles of one register. No result depends on its length.
template <typename Registers>
class PanelLoops {
 public:
  [[gnu::always_inline]] static void multiply(const double* panel, PanelShape shape, const Vec2* x,
                                              PanelRows sum) {
    for (std::size_t k = 0; k < shape.pivots; k += kPack)
      at_block(
          panel, shape, k,
          [&]<std::size_t kWidth>(const double* block, std::size_t length)
              __attribute__((always_inline)) {
                k == 0 ? add_block<kWidth, true>(block, length, x, sum)
                       : add_block<kWidth, false>(block, length, x + k, sum + row_entry(k));
              });
  }

  [[gnu::always_inline]] static void multiply_transposed(const double* panel, PanelShape shape,
                                                         const double* y, Vec2* x) {
    for (std::size_t k = padded(shape.pivots, kPack); k > 0;) {
      k -= kPack;
      at_block(
          panel, shape, k,
          [&]<std::size_t kWidth>(const double* block, std::size_t length) __attribute__((
              always_inline)) { dot_block<kWidth>(block, length, y + row_entry(k), x + k); });
    }
  }

 private:
  using Lanes = typename Registers::Lanes;
  static constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(double);
  static constexpr std::size_t kTwoRows = 2 * kDuo;  ///< numbers of two rows, both right-hand sides
  static constexpr std::size_t kParts = kTwoRows / kLanes;

  [[gnu::always_inline]] static Lanes& lanes(double* x) { return *reinterpret_cast<Lanes*>(x); }
  [[gnu::always_inline]] static const Lanes& lanes(const double* x) {
    return *reinterpret_cast<const Lanes*>(x);
  }

  /// x for two rows of each right-hand side.
  [[gnu::always_inline]] static void spread_pivot(const Vec2& x, Lanes (&weight)[kParts]) {
    const double both[kTwoRows] = {x.x(), x.x(), x.y(), x.y()};
    for (std::size_t p = 0; p < kParts; ++p) weight[p] = lanes(both + p * kLanes);
  }

  /// The sums of two rows so far.
  template <bool kIsFirst>
  [[gnu::always_inline]] static void begin_rows(const double* sum, Lanes (&total)[kParts]) {
    for (std::size_t p = 0; p < kParts; ++p)
      total[p] = kIsFirst ? Lanes{} : lanes(sum + p * kLanes);
  }

  /// A block of kWidth columns of `length` rows each; the first block initializes the sums.
  template <std::size_t kWidth, bool kIsFirst>
  [[gnu::always_inline]] static void add_block(const double* block, std::size_t length,
                                               const Vec2* x, PanelRows sum) {
    Lanes weight[kWidth][kParts];
    for (std::size_t k = 0; k < kWidth; ++k) spread_pivot(x[k], weight[k]);
    for (std::size_t r = 0; r < length; r += kDuo, sum += kTwoRows) {
      Lanes total[kParts];
      begin_rows<kIsFirst>(sum, total);
      for (std::size_t k = 0; k < kWidth; ++k) {
        Lanes entry;
        spread(block + r * kWidth + k * kDuo, entry);
        for (std::size_t p = 0; p < kParts; ++p) total[p] += entry * weight[k][p];
      }
      for (std::size_t p = 0; p < kParts; ++p) lanes(sum + p * kLanes) = total[p];
    }
  }

  template <std::size_t kWidth>
  [[gnu::always_inline]] static void dot_block(const double* block, std::size_t length,
                                               const double* y, Vec2* x) {
    Lanes total[kWidth][kParts] = {};
    for (std::size_t r = length; r > 0;) {
      r -= kDuo;
      for (std::size_t k = 0; k < kWidth; ++k) {
        Lanes entry;
        spread(block + r * kWidth + k * kDuo, entry);
        for (std::size_t p = 0; p < kParts; ++p)
          total[k][p] += entry * lanes(y + row_entry(r) + p * kLanes);
      }
    }
    for (std::size_t k = 0; k < kWidth; ++k) {
      double both[kTwoRows];
      for (std::size_t p = 0; p < kParts; ++p) lanes(both + p * kLanes) = total[k][p];
      x[k] = Vec2(both[0] + both[1], both[2] + both[3]);
    }
  }

  /// Calls visit<width>(first entry, rows) for the block of columns that starts with column k.
  template <typename Visit>
  [[gnu::always_inline]] static void at_block(const double* panel, PanelShape shape, std::size_t k,
                                              Visit visit) {
    const std::size_t length = shape.height() - k;
    const double* block = panel + shape.block_begin(k);
    switch (shape.width(k)) {
      case 1:
        return visit.template operator()<1>(block, length);
      case 2:
        return visit.template operator()<2>(block, length);
      case 3:
        return visit.template operator()<3>(block, length);
      default:
        return visit.template operator()<kPack>(block, length);
    }
  }
};

void multiply_baseline(const double* panel, PanelShape shape, const Vec2* x, PanelRows sum) {
  PanelLoops<PanelBaseline>::multiply(panel, shape, x, sum);
}

void transposed_baseline(const double* panel, PanelShape shape, const double* y, Vec2* x) {
  PanelLoops<PanelBaseline>::multiply_transposed(panel, shape, y, x);
}

[[gnu::target("avx2")]] void multiply_avx2(const double* panel, PanelShape shape, const Vec2* x,
                                           PanelRows sum) {
  PanelLoops<PanelAvx2>::multiply(panel, shape, x, sum);
}

[[gnu::target("avx2")]] void transposed_avx2(const double* panel, PanelShape shape, const double* y,
                                             Vec2* x) {
  PanelLoops<PanelAvx2>::multiply_transposed(panel, shape, y, x);
}

}  // namespace

PanelKernels baseline_panel_kernels() { return {multiply_baseline, transposed_baseline}; }

PanelKernels panel_kernels() {
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  return has_avx2 ? PanelKernels{multiply_avx2, transposed_avx2} : baseline_panel_kernels();
}

}  // namespace unwrapd::linear
