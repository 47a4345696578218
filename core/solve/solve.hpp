#pragma once
// One chart, one method: ASAP directly, ARAP and Hybrid by local/global iterations.

#include <optional>
#include <vector>

#include "core/solve/arap/accelerate_race.hpp"
#include "core/solve/arap/local_global.hpp"
#include "core/solve/base/solution.hpp"
#include "core/solve/maps/conformal_system.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve {

/// What a solver reads of the options of a job.
struct SolveOptions {
  SolveOptions(const UnwrapOptions& options)  // NOLINT(google-explicit-constructor): a part of them
      : method(options.method),
        lambda_units(options.lambda_units),
        initial(options.initial),
        pins(options.pins),
        stop(options.stop) {}

  Method method;
  LambdaUnits lambda_units;
  InitialMap initial;
  Pins pins;
  Stop stop;
};

void describe(CacheKey& key, const SolveOptions& options);

/// One disk under one set of options. What depends on the mesh and on which vertices are held (the
/// initial maps, the factored system) is made when it is first needed and kept: another lambda
/// costs iterations only. Used by one thread at a time.
class Solver {
 public:
  /// disk and executor must outlive the solver. Under holds, and wherever there is
  /// a held.start, the iterations start from it, whatever options.initial says.
  Solver(const Disk& disk, const SolveOptions& options, ConstrainedStart constrained,
         Executor& executor);

  /// Holds the same vertices, with the same weights, at other places: nothing is factored again.
  void move(ConstrainedStart constrained);

  /// Solves by options.method; lambda counts for Method::hybrid, in options.lambda_units. The same
  /// whatever was run before. Throws Error{solver_failed, cancelled}.
  Solution run(double lambda, const SolveWatch& watch);

  /// The system of the iterations; null where no run has needed it yet.
  [[nodiscard]] const arap::GlobalStep* global() const { return global_ ? &*global_ : nullptr; }

  /// The disk, the options and what is held: with lambda all that run() depends on.
  friend void describe(CacheKey& key, const Solver& solver);

 private:
  const UvMap& start();
  const UvMap* second_start();
  const UvMap& conformal();
  UvMap conformal_under_holds();
  [[nodiscard]] bool is_automatic() const;
  void factor(const SolveWatch& watch);
  bool stays_open(const arap::Rigidity& rigidity, const SolveWatch& watch);
  Solution hybrid(const arap::Rigidity& rigidity, const SolveWatch& watch);
  Solution iterate(const arap::Rigidity& rigidity, const SolveWatch& watch);
  Solution iterate_plainly(const arap::Race& race);

  const Disk& disk_;
  const SolveOptions options_;
  VertexConstraints holds_;
  UvMap held_start_;
  Executor& executor_;
  std::optional<UvMap> start_, second_start_;
  bool starts_from_frames_ = false;
  std::optional<UvMap> conformal_;
  std::optional<arap::GlobalStep> global_;
  std::optional<maps::ConformalSystem> conformal_system_;
};

/// The map that the iterations start from, scaled so that UV area = 3D area. Throws
/// Error{solver_failed}.
/// mean_value and tutte have no flipped triangles on a disk of one boundary whose inner edges do
/// not join boundary vertices; lscm may have some. automatic: map_from_rotations(), which is exact
/// on developable disks and elsewhere some ten iterations ahead of the others; where it has
/// collapsed, lscm. It may have flips too. Solver then tries lscm beside it, where that may pay
/// (run_race()); under a given number of plain iterations only with several boundaries.
UvMap initial_map(const Disk& disk, InitialMap kind, const arap::GlobalStep& global);

}  // namespace unwrapd::solve
