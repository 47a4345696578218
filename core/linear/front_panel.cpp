// Panels are read once in each direction, and reading them is what a solve costs: blocks of four
// columns share every load and store of the vectors. The way up reads every number before the one
// read last, from the end of the last panel to the start of the first: processors foresee a walk
// backwards as well as one forwards, but not panels read forwards one before the other (up to 2.5
// times slower, and asking for them ahead by instructions did not help).
#include "core/linear/front_panel.hpp"

namespace unwrapd {
namespace {

/// Two numbers in one register of the x86-64 baseline.
using Duo = double __attribute__((vector_size(16), aligned(8), may_alias));

const Duo& duo(const double* x) { return *reinterpret_cast<const Duo*>(x); }
Duo& duo(double* x) { return *reinterpret_cast<Duo*>(x); }

/// A block of kWidth columns of `length` rows each.
template <std::size_t kWidth>
void add_block(const double* block, std::size_t length, PanelVectors x, PanelVectors sum) {
  Duo xu[kWidth], xv[kWidth];
  for (std::size_t k = 0; k < kWidth; ++k) {
    xu[k] = Duo{x.u[k], x.u[k]};
    xv[k] = Duo{x.v[k], x.v[k]};
  }
  for (std::size_t r = 0; r < length; r += kDuo) {
    Duo u = duo(sum.u + r), v = duo(sum.v + r);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const Duo p = duo(block + r * kWidth + k * kDuo);
      u += p * xu[k];
      v += p * xv[k];
    }
    duo(sum.u + r) = u;
    duo(sum.v + r) = v;
  }
}

template <std::size_t kWidth>
void dot_block(const double* block, std::size_t length, PanelVectors y, PanelVectors x) {
  Duo u[kWidth] = {}, v[kWidth] = {};
  for (std::size_t r = length; r > 0;) {
    r -= kDuo;
    const Duo yu = duo(y.u + r), yv = duo(y.v + r);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const Duo p = duo(block + r * kWidth + k * kDuo);
      u[k] += p * yu;
      v[k] += p * yv;
    }
  }
  for (std::size_t k = 0; k < kWidth; ++k) {
    x.u[k] = u[k][0] + u[k][1];
    x.v[k] = v[k][0] + v[k][1];
  }
}

/// Calls visit<width>(first column, first entry, rows) for a block of columns.
template <typename Visit>
void at_block(const double* panel, PanelShape shape, std::size_t k, Visit visit) {
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

PanelVectors from(PanelVectors x, std::size_t k) { return {x.u + k, x.v + k}; }

}  // namespace

void multiply_panel(const double* panel, PanelShape shape, PanelVectors x, PanelVectors sum) {
  for (std::size_t k = 0; k < shape.pivots; k += kPack)
    at_block(panel, shape, k, [&]<std::size_t kWidth>(const double* block, std::size_t length) {
      add_block<kWidth>(block, length, from(x, k), from(sum, k));
    });
}

void multiply_transposed(const double* panel, PanelShape shape, PanelVectors y, PanelVectors x) {
  for (std::size_t k = padded(shape.pivots, kPack); k > 0;) {
    k -= kPack;
    at_block(panel, shape, k, [&]<std::size_t kWidth>(const double* block, std::size_t length) {
      dot_block<kWidth>(block, length, from(y, k), from(x, k));
    });
  }
}

}  // namespace unwrapd
