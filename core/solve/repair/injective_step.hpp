#pragma once
// A descent step that keeps an injective map injective.

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "core/measure/overlaps.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"

namespace unwrapd::solve::repair {

/// The parameters of the line search.
struct InjectiveStep {
  static constexpr double kShareOfFlip = 0.8;  ///< of the step at which the first triangle flips
  static constexpr double kArmijo = 1e-4;      ///< of the decrease that the gradient promises
  static constexpr int kMostHalvings = 40;
};

/// Takes the step, or half of it, or a quarter, and so on, but no step that turns a triangle over:
/// the first that lowers the energy by enough (Armijo) and leaves the map injective by the exact
/// test. energy(uv): infinite if a triangle is flipped; slope: the gradient times the step. Returns
/// the new energy; empty, with uv as it was, if no step succeeds.
template <class Energy>
std::optional<double> injective_step(const Disk& disk, std::span<const Vec2> step, double slope,
                                     const Energy& energy, UvMap& uv) {
  if (!(slope < 0)) return std::nullopt;
  SerialExecutor serial;
  const double before = energy(uv);
  double length =
      std::min(1.0, InjectiveStep::kShareOfFlip * methods::step_to_flip(disk, uv, step, serial));
  for (int k = 0; k < InjectiveStep::kMostHalvings; ++k, length /= 2) {
    UvMap next = uv;
    for (std::size_t v = 0; v < next.size(); ++v) next[v] += length * step[v];
    const double after = energy(next);
    if (!(after <= before + InjectiveStep::kArmijo * length * slope)) continue;
    if (!measure::is_plainly_injective(disk.faces, disk.loops, next)) continue;
    uv = std::move(next);
    return after;
  }
  return std::nullopt;
}

}  // namespace unwrapd::solve::repair
