#pragma once
// The iterations of ARAP and Hybrid, accelerated until convergence.

#include "core/solve/arap/accelerate_memory.hpp"
#include "core/solve/arap/local_global.hpp"

namespace unwrapd::solve::arap {

/// One accelerated descent, which the caller steps through.
class Descent {
 public:
  /// Starts from the map start, in which hard constraints hold. The members of assembly and the
  /// executor must outlive the descent.
  Descent(const Assembly& assembly, const UvMap& start, const Rigidity& rigidity,
          Executor& executor);

  /// One iteration: one solve and, nearly always, one evaluation of the energy, which never rises.
  /// Returns false and changes nothing if double precision finds no lower energy (converged), or if
  /// the map would shrink to less than kMinAreaShare of the start's area (collapse_guard; only for
  /// finite lambda, since ARAP's energy does not fall towards a point). solution() has the reason.
  bool step();

  /// The solution; its map is that of the last call of told().
  [[nodiscard]] const Solution& solution() const { return solution_; }

  /// The solution with the present map.
  const Solution& told();

  [[nodiscard]] double energy() const { return solution_.energy.back(); }

  /// Whether the last kWindow iterations lowered the energy by at most this share, or the energy is
  /// nearly zero.
  [[nodiscard]] bool has_converged(double tolerance) const;

  /// Prepends the iterations of another descent, whose map had a higher energy. The change from
  /// that map to this one counts as one iteration.
  void take_over(const Solution& before);

  /// The solution with the present map and this stop reason.
  Solution finish(StopReason reason) &&;

  /// A window of five iterations would stop on plateaus, where flaps of a shape are about to turn
  /// over (Cow, Beetle: 2 and 10 % above the minimum that follows).
  static constexpr std::size_t kWindow = 10;
  static constexpr double kNothing = 1e-16;  ///< energy of a map that is isometric to 1e-8

 private:
  bool advance(double slope, std::span<const Vec2> direction);
  double try_step(double length, std::span<const Vec2> direction);

  const GlobalStep& global_;
  Objective objective_;
  StepMemory memory_;
  Solution solution_{};
  Slope now_, before_;
  UvMap uv_, trial_;  // as all vectors here, in rank order
  std::vector<Vec2> step_, direction_, force_at_trial_;
  double least_area_ = 0;
  bool has_stepped_ = false;  // whether step_ has not been learnt yet
};

struct DescentOptions {
  double tolerance = 1e-6;
  int max_iterations = 500;  ///< includes those before the call
};

/// Steps until the descent ends, and returns the reason: converged, max_iterations or
/// collapse_guard. Throws Error{cancelled} within one iteration of a stop request.
StopReason run(Descent& descent, const DescentOptions& options, const LoopWatch& watch);

}  // namespace unwrapd::solve::arap
