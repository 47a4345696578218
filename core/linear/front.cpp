// The kernels, compiled twice: for the x86-64 baseline and for AVX2 without fused operations, so
// that both round alike.
#include "core/linear/front.hpp"

#include <algorithm>

#include "core/linear/front_kernels.hpp"

namespace unwrapd {
namespace {

using Duo = double __attribute__((vector_size(16), aligned(8), may_alias));
using Quad = double __attribute__((vector_size(32), aligned(8), may_alias));

template <typename Lanes>
[[gnu::always_inline]] inline bool factor(const FrontView& front, double* panel) {
  const FrontKernels<Lanes> kernels(front);
  if (!kernels.factor()) return false;
  kernels.write_panel(panel);
  return true;
}

[[gnu::target("avx2")]] bool factor_avx2(const FrontView& front, double* panel) {
  return factor<Quad>(front, panel);
}

}  // namespace

void Front::reset(PanelShape shape) {
  view_.shape = shape;
  view_.stride = padded(view_.size(), kStrip);
  const std::size_t column_count = padded(view_.size(), kPack);
  view_.columns = columns_.room(view_.stride * column_count);
  view_.strips = strips_.room(view_.stride * shape.pivots);
  view_.inverse = inverse_.room(kPack * view_.update_begin());
  for (std::size_t j = 0; j < column_count; ++j) {
    const std::size_t from = j / kStrip * kStrip;
    std::fill_n(view_.columns + j * view_.stride + from, view_.stride - from, 0.0);
  }
}

bool Front::factor(double* panel) const {
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  return has_avx2 ? factor_avx2(view_, panel) : factor_on_baseline(panel);
}

bool Front::factor_on_baseline(double* panel) const { return unwrapd::factor<Duo>(view_, panel); }

}  // namespace unwrapd
