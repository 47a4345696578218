#pragma once
// The local step: fits a similarity to the image of each triangle (Secs. 4.1, 5).

#include <limits>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/measure/jacobian.hpp"
#include "core/solve/arap/face_blocks.hpp"

namespace unwrapd::solve::arap {

/// The weight that pulls a triangle's fit towards a rotation: the dimensionless lambda of
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

inline constexpr int kMaxNewtonSteps = 64;        ///< median 3; the triple root at w = 1/2 takes 47
inline constexpr double kNewtonTolerance = 1e-8;  ///< of a step to r: its square is what is left

/// The scale of the best similarity for a Jacobian whose own is q: the positive root of
/// lambda r (r^2 - 1) + r - q; 1 where lambda is infinite.
double hybrid_scale(double lambda, double q);

/// The minimiser of A_t |J - L|^2 + A_t lambda (a^2 + b^2 - 1)^2 over all similarities L.
Similarity fit_similarity(const measure::Jacobian& j, double lambda);

/// A_t |J - L|^2 + A_t lambda (a^2 + b^2 - 1)^2 for the fitted L.
double fit_energy(const measure::Jacobian& j, const Similarity& fit, double area, double lambda);

/// Sums over all triangles of a map.
struct LocalSums {
  double energy = 0;   ///< under the best fits
  double uv_area = 0;  ///< sum of A_t |det J_t|
};

/// Fits every triangle. force[r] becomes -dE/du of the vertex of rank r: the right-hand side of
/// Eq. (4) minus its left-hand side. uv and force go by ranks; beyond: scratch, one for each of
/// blocks.beyond. The same bits for any executor and on any processor.
struct LocalStep {
  const FaceBlocks& blocks;
  std::span<const Vec2> uv;
  Rigidity rigidity;
  std::span<Vec2> force, beyond;

  LocalSums run(Executor& executor) const;

  /// The same with the registers of the x86-64 baseline, for comparison.
  LocalSums run_on_baseline(Executor& executor) const;
};

}  // namespace unwrapd::solve::arap
