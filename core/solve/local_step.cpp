// The local step of Liu, Zhang, Xu, Gotsman, Gortler, "A Local/Global Approach to Mesh
// Parameterization", SGP 2008 (Secs. 4.1, 4.4.1, 5, App. B).
//
// With the map u held fixed, each triangle takes the L = [a b; -b a] of least energy. Put
// (a, b) = r d, |d| = 1: whatever r is, the best d is the turn of the Jacobian's similarity part
// (e, -h), which is (C2, C3) / C1 of App. B. What remains is one cubic in r, without the division
// by C2 of Eq. (B3), which vanishes at quarter turns:
//   g(r) = w r^3 + (1 - 2w) r - (1 - w) Q,   w = lambda / (1 + lambda),   Q = |(e, h)|.
// w = 0 is ASAP (r = Q) and w = 1 is ARAP (r = 1).
#include "core/solve/local_step.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace unwrapd {
namespace {

constexpr int kMaxNewtonSteps = 64;         // median 6; the triple root at w = 1/2 takes 47
constexpr double kNewtonTolerance = 1e-15;  // relative to r
constexpr std::size_t kBlock = 4096;  // faces a block: fixed, so sums do not depend on threads

/// The positive root of g. g is convex there and g(max(1, Q)) >= 0: Newton descends to the root.
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

/// L x
Vec2 apply(const Similarity& l, const Vec2& x) {
  return {l.a * x.x() + l.b * x.y(), -l.b * x.x() + l.a * x.y()};
}

void write_residual(const RestTriangle& rest, const UvEdges& u, const Similarity& fit,
                    Vec2* residual) {
  std::array<Vec2, 3> d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = rest.cot[i] * (apply(fit, rest.edge[i]) - u[i]);
  residual[0] = d[0] - d[2];
  residual[1] = d[1] - d[0];
  residual[2] = d[2] - d[1];
}

}  // namespace

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

double local_step(const Triangulation& mesh, std::span<const Vec2> uv, const Rigidity& rigidity,
                  std::span<Vec2> residual, Executor& executor) {
  const std::size_t count = mesh.faces.size();
  assert(mesh.rest.size() == count && residual.size() == 3 * count);
  std::vector<double> energy((count + kBlock - 1) / kBlock, 0.0);
  executor.for_each_block(static_cast<int>(energy.size()), [&](int block) {
    const auto b = static_cast<std::size_t>(block);
    double sum = 0;
    for (std::size_t t = b * kBlock; t < std::min(count, (b + 1) * kBlock); ++t) {
      const RestTriangle& rest = mesh.rest[t];
      const UvEdges u = uv_edges(mesh.faces[t], uv);
      const Jacobian j = jacobian(rest, u);
      const double lambda = rigidity.at(rest.area);
      const Similarity fit = fit_similarity(j, lambda);
      sum += fit_energy(j, fit, rest.area, lambda);
      write_residual(rest, u, fit, &residual[3 * t]);
    }
    energy[b] = sum;
  });
  double total = 0;
  for (double e : energy) total += e;
  return total;
}

}  // namespace unwrapd
