#pragma once
// Linear ABF (Zayer, Levy, Seidel, "Linear Angle Based Parameterization", SGP 2007).

#include "core/base/executor.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"
#include "core/solve/methods/angle_system.hpp"

namespace unwrapd::solve::methods {

/// The angles that fit together in the plane to first order, with the least relative deviation from
/// the targets: one linear solve. An angle may leave (0, pi) if its target is far from flat. Throws
/// Error{solver_failed}.
std::vector<FaceAngles> linear_angles(const Disk& disk, Executor& executor);

/// The map of linear_angles(). energy as in FlatAngles: first of the targets, then of the angles.
/// Throws Error{solver_failed, cancelled}.
Solution linabf(const Disk& disk, const SolveWatch& watch, Executor& executor);

}  // namespace unwrapd::solve::methods
