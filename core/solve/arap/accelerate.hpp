#pragma once
// The iterations of ARAP and Hybrid, accelerated to true convergence.

#include "core/solve/arap/accelerate_memory.hpp"
#include "core/solve/arap/local_global.hpp"

namespace unwrapd::solve::arap {

/// One descent, iteration by iteration.
class Descent {
 public:
  /// From the map start, in which fixed vertices lie where they are held. What assembly refers to,
  /// and executor, must outlive the descent.
  Descent(const Assembly& assembly, const UvMap& start, const Rigidity& rigidity,
          Executor& executor);

  /// One iteration: one solve and, nearly always, one evaluation of the energy, which never rises.
  /// False, and nothing is done, when double precision knows no lower energy (converged) or the map
  /// would shrink to less than kMinAreaShare of the start's area (collapse_guard; the energies of
  /// finite lambda only, because that of ARAP does not fall towards a point): solution() tells.
  bool step();

  /// But for its map, which is that of the last told().
  [[nodiscard]] const Solution& solution() const { return solution_; }

  /// With the map so far.
  const Solution& told();

  [[nodiscard]] double energy() const { return solution_.energy.back(); }

  /// Whether the energy has fallen by no more than this share over the last kWindow iterations, or
  /// to nothing.
  [[nodiscard]] bool has_converged(double tolerance) const;

  /// Goes on as if it came after the iterations of another descent, whose map had a higher energy:
  /// the change from that map to its own counts as one iteration.
  void take_over(const Solution& before);

  /// The map so far, with stop_reason.
  Solution finish(StopReason reason) &&;

  /// Five iterations would stop on the plateaus where flaps of a shape are about to turn over (Cow,
  /// Beetle: 2 and 10 % above the minimum that follows).
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
  UvMap uv_, trial_;  // as all vectors here, by ranks
  std::vector<Vec2> step_, direction_, force_at_trial_;
  double least_area_ = 0;
  bool has_stepped_ = false;  // step_ is yet to be learnt
};

struct DescentOptions {
  double tolerance = 1e-6;
  int max_iterations = 500;  ///< those before the call included
};

/// Steps until the descent ends, and tells why: converged, max_iterations or collapse_guard.
/// Throws Error{cancelled} within one iteration of a stop request.
StopReason run(Descent& descent, const DescentOptions& options, const LoopWatch& watch);

}  // namespace unwrapd::solve::arap
