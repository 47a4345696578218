#pragma once
// ABF++ (Sheffer, Levy, Mogilnitsky, Bogomyakov 2005): the map whose angles are nearest to the
// mesh's.

#include <functional>
#include <stop_token>

#include "core/base/executor.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/solution.hpp"
#include "core/solve/methods/angle_system.hpp"

namespace unwrapd::solve::methods {

/// Angles that flatten the mesh, and how they were found.
struct FlatAngles {
  std::vector<FaceAngles> angles;  ///< all in (0, pi)
  std::vector<double> energy;      ///< angle_energy() of the start and after every iteration
  int iterations = 0;
  StopReason stop_reason = StopReason::max_iterations;
};

/// Called after every iteration.
using AngleWatch = std::function<void(const FlatAngles&)>;

/// The angles that minimize the sum of (angle / target - 1)^2 among those that fit together in the
/// plane. Angles below a tenth of their target cost more, since the least energy may else lie at
/// angles of 0 (a sphere with a pinhole). Ends when the largest relative change of an angle falls
/// below 1e-7 (converged) or after kMaxAngleIterations. Throws Error{solver_failed, cancelled}.
FlatAngles flat_angles(const Disk& disk, const std::stop_token& stop,
                       const AngleWatch& on_iteration, Executor& executor);

inline constexpr int kMaxAngleIterations = 30;

/// The map of flat_angles(), with the same energy.
Solution abf(const Disk& disk, const SolveWatch& watch, Executor& executor);

}  // namespace unwrapd::solve::methods
