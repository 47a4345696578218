// The local step of Liu, Zhang, Xu, Gotsman, Gortler, "A Local/Global Approach to Mesh
// Parameterization", SGP 2008 (Secs. 4.1, 4.4.1, 5, App. B).
//
// With the map u held fixed, each triangle takes the L = [a b; -b a] of least energy. Put
// (a, b) = r d, |d| = 1: whatever r is, the best d is the turn of the Jacobian's similarity part
// (e, -h), which is (C2, C3) / C1 of App. B. What remains is one cubic in r, without the division
// by C2 of Eq. (B3), which vanishes at quarter turns:
//   g(r) = w r^3 + (1 - 2w) r - (1 - w) Q,   w = lambda / (1 + lambda),   Q = |(e, h)|.
// w = 0 is ASAP (r = Q) and w = 1 is ARAP (r = 1).
// LocalStep fits four triangles at once (local_step_simd.hpp).
#include "core/solve/arap/local_step.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/solve/arap/local_step_simd.hpp"

namespace unwrapd::solve::arap {
namespace {

/// The vertices of one block: their positions, and the forces on them.
class BlockVertices {
 public:
  BlockVertices(const LocalStep& step, const FaceBlock& block)
      : step_(step), block_(block), uv_(block.vertex_count()), force_(uv_.size(), Vec2::Zero()) {
    const auto own = step.uv.subspan(first(), count());
    std::copy(own.begin(), own.end(), uv_.begin());
    for (std::size_t k = 0; k < beyond().size(); ++k)
      uv_[count() + k] = step.uv[static_cast<std::size_t>(beyond()[k])];
  }

  [[nodiscard]] const double* uv() const { return uv_.front().data(); }
  [[nodiscard]] double* force() { return force_.front().data(); }

  /// Adds the forces on the block's own vertices; forces on vertices of other blocks go to a list.
  void give_back() const {
    std::copy_n(force_.begin(), count(), step_.force.begin() + block_.first);
    std::copy_n(force_.begin() + block_.own, beyond().size(),
                step_.beyond.begin() + static_cast<std::ptrdiff_t>(block_.beyond_begin));
  }

 private:
  [[nodiscard]] std::size_t first() const { return static_cast<std::size_t>(block_.first); }
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(block_.own); }
  [[nodiscard]] std::span<const Index> beyond() const {
    return std::span(step_.blocks.beyond)
        .subspan(block_.beyond_begin, block_.beyond_end - block_.beyond_begin);
  }

  const LocalStep& step_;
  const FaceBlock& block_;
  std::vector<Vec2> uv_, force_;
};

template <typename Registers>
[[gnu::always_inline]] inline LocalSums fit_block(const LocalStep& step, const FaceBlock& block) {
  BlockVertices vertices(step, block);
  SimdLocalStep<Registers> fit(vertices.uv(), vertices.force(), step.rigidity);
  for (std::size_t g = block.group_begin; g < block.group_end; ++g) fit.add(step.blocks.groups[g]);
  vertices.give_back();
  return fit.sums();
}

LocalSums fit_block_on_baseline(const LocalStep& step, const FaceBlock& block) {
  return fit_block<TwoLanes>(step, block);
}

[[gnu::target("avx2")]] LocalSums fit_block_avx2(const LocalStep& step, const FaceBlock& block) {
  return fit_block<FourLanes>(step, block);
}

using FitBlock = LocalSums (*)(const LocalStep& step, const FaceBlock& block);

LocalSums fit_all(const LocalStep& step, FitBlock fit, Executor& executor) {
  const FaceBlocks& blocks = step.blocks;
  std::vector<LocalSums> sums(blocks.all.size());
  executor.for_each_block(static_cast<int>(sums.size()), [&](int b) {
    sums[static_cast<std::size_t>(b)] = fit(step, blocks.all[static_cast<std::size_t>(b)]);
  });
  for (std::size_t k = 0; k < blocks.beyond.size(); ++k)
    step.force[static_cast<std::size_t>(blocks.beyond[k])] += step.beyond[k];
  LocalSums total;
  for (const LocalSums& own : sums) total.energy += own.energy, total.uv_area += own.uv_area;
  return total;
}

}  // namespace

/// g is convex: its tangent at 1, whose slope is 1 + w, crosses zero at or beyond the root, and
/// from there Newton descends to it.
double hybrid_scale(double lambda, double q) {
  if (std::isinf(lambda)) return 1;
  const double w = lambda / (1 + lambda), v = 1 / (1 + lambda);  // v: 1 - w without its rounding
  double r = 1 + (q - 1) / (1 + 2 * lambda);
  for (int k = 0; k < kMaxNewtonSteps; ++k) {
    const double g = w * r * (r * r - 1) + v * (r - q);
    const double slope = w * (3 * r * r - 1) + v;
    const double step = slope > 0 ? g / slope : 0;
    r -= step;
    if (step <= kNewtonTolerance * r) break;
  }
  return r;
}

Similarity fit_similarity(const measure::Jacobian& j, double lambda) {
  assert(lambda >= 0);
  const double q = j.turn_scale();
  const double r = hybrid_scale(lambda, q);
  if (!(q > 0)) return {r, 0};  // a collapsed image: all rotations fit equally
  return {r * j.e / q, -r * j.h / q};
}

double fit_energy(const measure::Jacobian& j, const Similarity& fit, double area, double lambda) {
  const double de = j.e - fit.a, dh = j.h + fit.b;
  const double misfit = 2 * (de * de + dh * dh + j.f * j.f + j.g * j.g);
  const double excess = fit.a * fit.a + fit.b * fit.b - 1;
  return area * (misfit + (std::isinf(lambda) ? 0 : lambda * excess * excess));
}

LocalSums LocalStep::run(Executor& executor) const {
  assert(force.size() == uv.size() && beyond.size() == blocks.beyond.size());
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  return fit_all(*this, has_avx2 ? fit_block_avx2 : fit_block_on_baseline, executor);
}

LocalSums LocalStep::run_on_baseline(Executor& executor) const {
  return fit_all(*this, fit_block_on_baseline, executor);
}

}  // namespace unwrapd::solve::arap
