// Newton's method on the Lagrangian of
//   min sum w (alpha - beta)^2 / 2, w = 1 / beta^2,  subject to the constraints of AngleSystem.
// With the wheel in logarithms its Hessian is diagonal, w + csc^2(alpha) times a difference of
// wheel multipliers, where products of sines (ABF++ as published) fill it. An entry may be
// negative: it is held above a share of 1 / min(alpha, beta)^2, so that the reduced matrix stays
// definite and no angle is thought cheap to move by more than itself. That is also what makes full
// steps safe far from the solution; 1 / beta^2 alone stalls on spheres with a small hole.
// There the least of the sum lies at angles of 0. Angles below a tenth of their target therefore
// cost log(alpha / that tenth)^2 / 2 more, where Sheffer et al. raise weights until it helps.
#include "core/solve/methods/abf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::solve::methods {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastCurvature = 0.25;  // of 1 / min(alpha, beta)^2
constexpr double kMostOfTheWay = 0.9;     // of the distance to an angle of 0 or pi
constexpr double kSlim = 0.1;             // of its target: a smaller angle costs extra
constexpr double kTolerance = 1e-7;       // relative to an angle

double square(double x) { return x * x; }

/// The wheel multiplier of a corner's ring; 0 if the corner has no ring.
double wheel(const Triangle& face, std::size_t corner, const AngleSystem& system) {
  const Index ring = system.rings().of.slot[static_cast<std::size_t>(face[corner])];
  return ring == linear::kFixed ? 0 : system.multipliers()[static_cast<std::size_t>(ring)][1];
}

class AngleNewton {
 public:
  AngleNewton(const Disk& disk, Executor& executor)
      : disk_(disk),
        system_(disk, executor),
        target_(target_angles(disk)),
        angles_(target_),
        model_{angles_, angles_} {}

  [[nodiscard]] const std::vector<FaceAngles>& angles() const { return angles_; }

  [[nodiscard]] double energy() const { return angle_energy(system_, angles_, target_); }

  /// Returns the largest relative change of an angle.
  double iterate() {
    for (std::size_t t = 0; t < angles_.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) set_model(t, i);
    const std::vector<FaceAngles> change = system_.step(angles_, model_);
    const double length = longest_step(change);
    double largest = 0;
    for (std::size_t t = 0; t < angles_.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(change[t][i]) / angles_[t][i]);
        angles_[t][i] += length * change[t][i];
      }
    return largest;
  }

 private:
  void set_model(std::size_t t, std::size_t i) {
    const double alpha = angles_[t][i], beta = target_[t][i];
    const Triangle& face = disk_.faces[t];
    const double bend = wheel(face, (i + 1) % 3, system_) - wheel(face, (i + 2) % 3, system_);
    const double depth = std::min(0.0, std::log(alpha / (kSlim * beta)));
    const double hold = depth < 0 ? (1 - depth) / square(alpha) : 0;  // curvature of depth^2 / 2
    const double curvature = 1 / square(beta) + hold + bend / square(std::sin(alpha));
    model_.slope[t][i] = (alpha - beta) / square(beta) + depth / alpha;
    model_.curvature[t][i] = std::max(curvature, kLeastCurvature / square(std::min(alpha, beta)));
  }

  /// The longest step, at most 1, that keeps all angles in (0, pi).
  [[nodiscard]] double longest_step(const std::vector<FaceAngles>& change) const {
    double length = 1;
    for (std::size_t t = 0; t < angles_.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const double room = change[t][i] < 0 ? angles_[t][i] : kPi - angles_[t][i];
        const double way = std::abs(change[t][i]);
        if (length * way > kMostOfTheWay * room) length = kMostOfTheWay * room / way;
      }
    return length;
  }

  const Disk& disk_;
  AngleSystem system_;
  std::vector<FaceAngles> target_;
  std::vector<FaceAngles> angles_;
  AngleModel model_;
};

}  // namespace

FlatAngles flat_angles(const Disk& disk, const std::stop_token& stop,
                       const AngleWatch& on_iteration, Executor& executor) {
  AngleNewton newton(disk, executor);
  FlatAngles flat{newton.angles(), {newton.energy()}};
  while (flat.iterations < kMaxAngleIterations && flat.stop_reason != StopReason::converged) {
    throw_if_cancelled(stop);
    if (newton.iterate() < kTolerance) flat.stop_reason = StopReason::converged;
    flat.angles = newton.angles();
    flat.energy.push_back(newton.energy());
    ++flat.iterations;
    if (on_iteration) on_iteration(flat);
  }
  return flat;
}

Solution abf(const Disk& disk, const SolveWatch& watch, Executor& executor) {
  if (watch.on_stage) watch.on_stage(Stage::solve);
  Solution solution;
  const auto take = [&](const FlatAngles& flat) {
    solution.uv = map_of_angles(disk, flat.angles);
    solution.energy = flat.energy;
    solution.iterations = flat.iterations;
    solution.stop_reason = flat.stop_reason;
  };
  AngleWatch on_iteration;
  if (watch.loop.on_iteration)
    on_iteration = [&](const FlatAngles& flat) { take(flat), watch.loop.on_iteration(solution); };
  const FlatAngles flat = flat_angles(disk, watch.loop.stop, on_iteration, executor);
  if (!watch.loop.on_iteration) take(flat);
  return solution;
}

}  // namespace unwrapd::solve::methods
