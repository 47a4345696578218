// The local step of Liu, Zhang, Xu, Gotsman, Gortler, "A Local/Global Approach to Mesh
// Parameterization", SGP 2008 (Secs. 4.1, 4.4.1, 5, App. B).
//
// With the map u held fixed, each triangle takes the L = [a b; -b a] of least energy. Put
// (a, b) = r d, |d| = 1: whatever r is, the best d is the turn of the Jacobian's similarity part
// (e, -h), which is (C2, C3) / C1 of App. B. What remains is one cubic in r, without the division
// by C2 of Eq. (B3), which vanishes at quarter turns:
//   g(r) = w r^3 + (1 - 2w) r - (1 - w) Q,   w = lambda / (1 + lambda),   Q = |(e, h)|.
// w = 0 is ASAP (r = Q) and w = 1 is ARAP (r = 1).
// local_step() fits four triangles at once (fit_abreast.hpp).
#include "core/solve/local_step.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/solve/fit_abreast.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kBlock = 1024;  // groups a block: fixed, so sums do not depend on threads

FaceGroup group_of(std::span<const RestTriangle> rest, std::span<const Triangle> faces) {
  FaceGroup group{};
  for (std::size_t k = 0; k < kFacesAbreast; ++k) {
    const std::size_t t = std::min(k, faces.size() - 1);
    const Vec2 first = -rest[t].edge[0], second = rest[t].edge[2];
    const double length = first.norm(), height = 2 * rest[t].area / length;
    for (std::size_t i = 0; i < 3; ++i) group.corner[i][k] = faces[t][i];
    group.across[k] = 1 / length;
    group.shear[k] = -first.dot(second) / (length * length * height);
    group.up[k] = 1 / height;
    group.area[k] = k == t ? rest[t].area : 0;
  }
  return group;
}

/// What one thread fits at once.
struct FitBlock {
  std::span<const FaceGroup> groups;
  std::span<const Vec2> uv;
  Rigidity rigidity;
  Vec2* residual;
};

template <typename Registers>
[[gnu::always_inline]] inline LocalSums fit_block(const FitBlock& block) {
  FitAbreast<Registers> fit(block.uv, block.rigidity);
  for (std::size_t g = 0; g < block.groups.size(); ++g)
    fit.add(block.groups[g], block.residual + 3 * kFacesAbreast * g);
  return fit.sums();
}

LocalSums fit_block_on_baseline(const FitBlock& block) { return fit_block<TwoLanes>(block); }

[[gnu::target("avx2")]] LocalSums fit_block_avx2(const FitBlock& block) {
  return fit_block<FourLanes>(block);
}

using FitBlocks = LocalSums (*)(const FitBlock& block);

LocalSums fit_all(const FitBlock& all, FitBlocks fit, Executor& executor) {
  const std::size_t count = all.groups.size();
  std::vector<LocalSums> sums((count + kBlock - 1) / kBlock);
  executor.for_each_block(static_cast<int>(sums.size()), [&](int b) {
    const std::size_t first = static_cast<std::size_t>(b) * kBlock;
    const std::size_t size = std::min(kBlock, count - first);
    sums[static_cast<std::size_t>(b)] = fit({all.groups.subspan(first, size), all.uv, all.rigidity,
                                             all.residual + 3 * kFacesAbreast * first});
  });
  LocalSums total;
  for (const LocalSums& own : sums) total.energy += own.energy, total.uv_area += own.uv_area;
  return total;
}

}  // namespace

/// g is convex there and g(max(1, Q)) >= 0: Newton descends to the root.
double hybrid_scale(double lambda, double q) {
  if (std::isinf(lambda)) return 1;
  const double w = lambda / (1 + lambda), v = 1 / (1 + lambda);  // v: 1 - w without its rounding
  double r = std::max(1.0, q);
  for (int k = 0; k < kMaxNewtonSteps; ++k) {
    const double g = w * r * (r * r - 1) + v * (r - q);
    const double slope = w * (3 * r * r - 1) + v;
    const double step = slope > 0 ? g / slope : 0;
    r -= step;
    if (step <= kNewtonTolerance * r) break;
  }
  return r;
}

Similarity fit_similarity(const Jacobian& j, double lambda) {
  assert(lambda >= 0);
  const double q = j.turn_scale();
  const double r = hybrid_scale(lambda, q);
  if (!(q > 0)) return {r, 0};  // a collapsed image: all turns fit alike
  return {r * j.e / q, -r * j.h / q};
}

double fit_energy(const Jacobian& j, const Similarity& fit, double area, double lambda) {
  const double de = j.e - fit.a, dh = j.h + fit.b;
  const double misfit = 2 * (de * de + dh * dh + j.f * j.f + j.g * j.g);
  const double excess = fit.a * fit.a + fit.b * fit.b - 1;
  return area * (misfit + (std::isinf(lambda) ? 0 : lambda * excess * excess));
}

std::vector<FaceGroup> face_groups(std::span<const RestTriangle> rest,
                                   std::span<const Triangle> faces) {
  assert(rest.size() == faces.size());
  std::vector<FaceGroup> groups;
  groups.reserve((faces.size() + kFacesAbreast - 1) / kFacesAbreast);
  for (std::size_t t = 0; t < faces.size(); t += kFacesAbreast) {
    const std::size_t count = std::min(kFacesAbreast, faces.size() - t);
    groups.push_back(group_of(rest.subspan(t, count), faces.subspan(t, count)));
  }
  return groups;
}

LocalSums local_step(std::span<const FaceGroup> groups, std::span<const Vec2> uv,
                     const Rigidity& rigidity, std::span<Vec2> residual, Executor& executor) {
  assert(residual.size() == 3 * kFacesAbreast * groups.size());
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  return fit_all({groups, uv, rigidity, residual.data()},
                 has_avx2 ? fit_block_avx2 : fit_block_on_baseline, executor);
}

LocalSums local_step_on_baseline(std::span<const FaceGroup> groups, std::span<const Vec2> uv,
                                 const Rigidity& rigidity, std::span<Vec2> residual,
                                 Executor& executor) {
  return fit_all({groups, uv, rigidity, residual.data()}, fit_block_on_baseline, executor);
}

}  // namespace unwrapd
