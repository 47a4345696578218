#pragma once
// The iterations of ARAP and Hybrid, accelerated to true convergence.

#include "core/solve/accelerate_memory.hpp"
#include "core/solve/local_global.hpp"

namespace unwrapd {

/// One descent, iteration by iteration.
class Descent {
 public:
  /// From the map start, in which fixed vertices lie where they are held. What assembly refers to,
  /// and executor, must outlive the descent.
  Descent(const Assembly& assembly, UvMap start, const Rigidity& rigidity, Executor& executor);

  /// One iteration: one solve and, nearly always, one evaluation of the energy, which never rises.
  /// False, and nothing is done, when double precision knows no lower energy (converged) or the map
  /// would shrink to less than kMinAreaShare of the start's area (collapse_guard; the energies of
  /// finite lambda only, because that of ARAP does not fall towards a point).
  bool step();

  /// The map so far; stop_reason is meant for when step() is false.
  [[nodiscard]] const Solution& solution() const { return solution_; }
  [[nodiscard]] double energy() const { return solution_.energy.back(); }

  /// Whether the energy has fallen by no more than this share over the last kWindow iterations, or
  /// to nothing.
  [[nodiscard]] bool has_converged(double tolerance) const;

  static constexpr std::size_t kWindow = 5;
  static constexpr double kNothing = 1e-18;  ///< energy of a map that is isometric to 1e-9

 private:
  bool advance(double slope, std::span<const Vec2> direction);
  double try_step(double length, std::span<const Vec2> direction);

  const GlobalStep& global_;
  const Disk& disk_;
  Objective objective_;
  StepMemory memory_;
  Solution solution_;
  Slope now_, before_;
  std::vector<Vec2> step_, direction_, force_at_trial_;
  UvMap trial_;
  double least_area_ = 0;
};

struct DescentOptions {
  double tolerance = 1e-6;
  int max_iterations = 500;
};

/// Steps until the energy has converged, the iterations so far included.
/// Throws Error{cancelled} within one iteration of a stop request.
Solution run_to_convergence(Descent& descent, const DescentOptions& options,
                            const LoopWatch& watch);

}  // namespace unwrapd
