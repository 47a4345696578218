#pragma once
// The local step: each triangle takes the similarity that fits its image best (Secs. 4.1, 5).

#include <limits>
#include <span>
#include <vector>

#include "core/executor.hpp"
#include "core/measure/jacobian.hpp"

namespace unwrapd {

/// How strongly a triangle's fit is held to a rotation: the dimensionless lambda of
///   E = sum A_t [ |J_t - L_t|^2 + lambda_t (a_t^2 + b_t^2 - 1)^2 ].
/// Eq. (5) as printed has no area in its second term: there lambda_t = lambda / (2 A_t).
struct Rigidity {
  double lambda = std::numeric_limits<double>::infinity();  ///< 0: ASAP, infinity: ARAP
  bool per_area = false;  ///< true: lambda is that of Eq. (5), in units of the rest areas

  [[nodiscard]] double at(double area) const { return per_area ? lambda / (2 * area) : lambda; }
};

/// L_t = [a b; -b a]: positive angle clockwise, as in Eq. (3).
struct Similarity {
  double a = 1, b = 0;
};

/// The minimiser of A_t |J - L|^2 + A_t lambda (a^2 + b^2 - 1)^2 over all similarities L.
Similarity fit_similarity(const Jacobian& j, double lambda);

/// A_t |J - L|^2 + A_t lambda (a^2 + b^2 - 1)^2 for the fitted L.
double fit_energy(const Jacobian& j, const Similarity& fit, double area, double lambda);

/// Rest triangles and the faces that they belong to, in step.
struct Triangulation {
  std::span<const RestTriangle> rest;
  std::span<const Triangle> faces;
};

/// Fits every triangle. Returns the energy of uv; residual[3t+i] becomes the share of corner i of
/// face t in the right-hand side of Eq. (4) minus its left-hand side.
/// residual has 3 entries a face. The sum is the same for any executor.
double local_step(const Triangulation& mesh, std::span<const Vec2> uv, const Rigidity& rigidity,
                  std::span<Vec2> residual, Executor& executor);

}  // namespace unwrapd
