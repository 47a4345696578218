// The kernels, compiled twice: for the x86-64 baseline and for AVX2 without fused operations, so
// that both round alike.
#include "core/linear/front.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/linear/front_kernels.hpp"

namespace unwrapd::linear {
namespace {

using Duo = double __attribute__((vector_size(16), aligned(8), may_alias));
using Quad = double __attribute__((vector_size(32), aligned(8), may_alias));

template <typename Lanes>
[[gnu::always_inline]] inline bool finish_front(const FrontView& front, Columns own) {
  return FrontKernels<Lanes>(front).finish(own);
}
template <typename Lanes>
[[gnu::always_inline]] inline void update_front(const FrontView& front, Columns done,
                                                Columns others) {
  FrontKernels<Lanes>(front).update(done, others);
}
template <typename Lanes>
[[gnu::always_inline]] inline void write_front(const FrontView& front, Columns own, double* panel) {
  FrontKernels<Lanes>(front).write_panel(own, panel);
}

bool finish_baseline(const FrontView& front, Columns own) { return finish_front<Duo>(front, own); }
void update_baseline(const FrontView& front, Columns done, Columns others) {
  update_front<Duo>(front, done, others);
}
void write_baseline(const FrontView& front, Columns own, double* panel) {
  write_front<Duo>(front, own, panel);
}

[[gnu::target("avx2")]] bool finish_avx2(const FrontView& front, Columns own) {
  return finish_front<Quad>(front, own);
}
[[gnu::target("avx2")]] void update_avx2(const FrontView& front, Columns done, Columns others) {
  update_front<Quad>(front, done, others);
}
[[gnu::target("avx2")]] void write_avx2(const FrontView& front, Columns own, double* panel) {
  write_front<Quad>(front, own, panel);
}

struct FrontPhases {
  bool (*finish)(const FrontView& front, Columns own);
  void (*update)(const FrontView& front, Columns done, Columns others);
  void (*write)(const FrontView& front, Columns own, double* panel);
};

constexpr FrontPhases kBaselinePhases{finish_baseline, update_baseline, write_baseline};
constexpr FrontPhases kAvx2Phases{finish_avx2, update_avx2, write_avx2};

constexpr std::size_t kPart = 32;         // columns for one task
constexpr std::size_t kWorthParts = 192;  // rows of a front below which threads do not pay

/// Calls work(part, columns) for parts of the columns in parallel, if there are enough. The results
/// do not depend on where the parts are divided.
template <typename Work>
void in_parts(const FrontView& front, Columns all, Executor& executor, Work work) {
  if (front.size() < kWorthParts) return work(0, all);
  const std::size_t count = (all.end - all.begin + kPart - 1) / kPart;
  executor.for_each_block(static_cast<int>(count), [&](int part) {
    const std::size_t begin = all.begin + static_cast<std::size_t>(part) * kPart;
    work(static_cast<std::size_t>(part), Columns{begin, std::min(begin + kPart, all.end)});
  });
}

bool factor_front(const FrontView& front, const FrontPhases& phases, double* panel,
                  Executor& executor) {
  const std::size_t pivots = front.shape.pivots;
  for (std::size_t k = 0; k < pivots; k += kBlock) {
    const Columns own{k, std::min(k + kBlock, pivots)};
    throw_if_cancelled(executor.stop());
    if (!phases.finish(front, own)) return false;
    in_parts(front, {padded(own.end, kPack), front.size()}, executor,
             [&](std::size_t, Columns others) { phases.update(front, own, others); });
  }
  in_parts(front, {0, pivots}, executor, [&](std::size_t part, Columns own) {
    FrontView mine = front;
    mine.inverse += part * kPack * front.update_begin();
    phases.write(mine, own, panel);
  });
  return true;
}

}  // namespace

void Front::reset(PanelShape shape) {
  view_.shape = shape;
  view_.stride = padded(view_.size(), kStrip);
  const std::size_t column_count = padded(view_.size(), kPack);
  view_.columns = columns_.room(view_.stride * column_count);
  view_.strips = strips_.room(view_.stride * shape.pivots);
  const std::size_t part_count =
      view_.size() < kWorthParts ? 1 : (shape.pivots + kPart - 1) / kPart;
  view_.inverse = inverse_.room(part_count * kPack * view_.update_begin());
  for (std::size_t j = 0; j < column_count; ++j) {
    const std::size_t from = j / kStrip * kStrip;
    std::fill_n(view_.columns + j * view_.stride + from, view_.stride - from, 0.0);
  }
}

bool Front::factor(double* panel, Executor& executor) const {
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  return factor_front(view_, has_avx2 ? kAvx2Phases : kBaselinePhases, panel, executor);
}

bool Front::factor(double* panel) const {
  SerialExecutor serial;
  return factor(panel, serial);
}

bool Front::factor_on_baseline(double* panel) const {
  SerialExecutor serial;
  return factor_front(view_, kBaselinePhases, panel, serial);
}

}  // namespace unwrapd::linear
