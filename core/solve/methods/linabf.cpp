// The wheel in logarithms, linearised at the targets gamma, makes all constraints linear in the
// errors e = alpha - gamma; the least sum of (e / gamma)^2 under linear constraints is one solve
// with a positive definite matrix. It is the first step of ABF's Newton method from the targets.
#include "core/solve/methods/linabf.hpp"

#include <algorithm>
#include <numbers>

#include "core/base/cancel.hpp"

namespace unwrapd::solve::methods {
namespace {

/// Below this share of its target an angle is out of the range of the linear model.
constexpr double kLeastShare = 0.1;

AngleModel relative_errors(const std::vector<FaceAngles>& target) {
  AngleModel model{std::vector<FaceAngles>(target.size(), FaceAngles{}), target};
  for (FaceAngles& k : model.curvature)
    for (double& x : k) x = 1 / (x * x);
  return model;
}

/// Raises angles that shrank too far; the others of the triangle make up for it.
FaceAngles raise_small_angles(FaceAngles angle, const FaceAngles& target) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += angle[i] = std::max(angle[i], kLeastShare * target[i]);
  for (double& x : angle) x *= std::numbers::pi / sum;
  return angle;
}

struct LinearAngles {
  std::vector<FaceAngles> angles;
  std::vector<double> energy;
};

LinearAngles solve(const Disk& disk, Executor& executor) {
  const std::vector<FaceAngles> target = target_angles(disk);
  AngleSystem system(disk, executor);
  LinearAngles linear{target, {angle_energy(system, target, target)}};
  const std::vector<FaceAngles> change = system.step(target, relative_errors(target));
  for (std::size_t t = 0; t < target.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) linear.angles[t][i] += change[t][i];
    linear.angles[t] = raise_small_angles(linear.angles[t], target[t]);
  }
  linear.energy.push_back(angle_energy(system, linear.angles, target));
  return linear;
}

}  // namespace

std::vector<FaceAngles> linear_angles(const Disk& disk, Executor& executor) {
  return solve(disk, executor).angles;
}

Solution linabf(const Disk& disk, const SolveWatch& watch, Executor& executor) {
  throw_if_cancelled(watch.loop.stop);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  LinearAngles linear = solve(disk, executor);
  Solution solution{.uv = map_of_angles(disk, linear.angles),
                    .energy = std::move(linear.energy),
                    .iterations = 1,
                    .stop_reason = StopReason::direct};
  if (watch.loop.on_iteration) watch.loop.on_iteration(solution);
  return solution;
}

}  // namespace unwrapd::solve::methods
