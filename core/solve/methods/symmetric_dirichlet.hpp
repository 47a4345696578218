#pragma once
// The symmetric Dirichlet energy (Schreiner, Asirvatham, Praun, Hoppe 2004; Smith, Schaefer 2015):
// least for isometric maps, and unbounded as a triangle approaches a flip.

#include <limits>
#include <span>

#include "core/base/executor.hpp"
#include "core/linear/pair_system.hpp"
#include "core/measure/jacobian.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::methods {

/// |J|^2 + |J^-1|^2: sigma^2 + 1 / sigma^2 summed over both singular values; 4 for an isometry.
/// Infinite if the determinant is not positive.
double symmetric_dirichlet(const measure::Jacobian& j);

/// The sum of A_t symmetric_dirichlet(J_t), at least 4 on a disk of area 1. Infinite if a triangle
/// is not strictly counter-clockwise, by an exact test. The same for any executor.
double symmetric_dirichlet_energy(const Disk& disk, std::span<const Vec2> uv, Executor& executor);

/// gradient[v] becomes dE/du_v. uv must have finite energy.
void symmetric_dirichlet_gradient(const Disk& disk, std::span<const Vec2> uv,
                                  std::span<Vec2> gradient, Executor& executor);

/// The scale s at which s uv has the least energy; the energy of uv must be finite.
double best_scale(const Disk& disk, std::span<const Vec2> uv);

/// The Hessian of the quadratic proxy of one face (Rabinovich et al. 2017, Sec. 4): the convex
/// |W (J - R)|^2, R the nearest rotation, whose gradient is the energy's at the current J.
linear::PairElement proxy_element(const measure::RestTriangle& rest, const measure::Jacobian& j);

/// The least t > 0 at which a triangle of uv + t step has no area; infinite if there is none
/// (Smith, Schaefer 2015, Sec. 3.3).
double step_to_flip(const Disk& disk, std::span<const Vec2> uv, std::span<const Vec2> step,
                    Executor& executor);

}  // namespace unwrapd::solve::methods
