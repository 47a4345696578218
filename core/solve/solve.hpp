#pragma once
// Solves one chart by one method: ASAP directly, ARAP and Hybrid by local/global iterations.

#include <optional>
#include <vector>

#include "core/solve/arap/accelerate_race.hpp"
#include "core/solve/arap/local_global.hpp"
#include "core/solve/base/solution.hpp"
#include "core/solve/maps/conformal_system.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve {

/// The options of a job that a solver reads.
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

/// One disk under one set of options. Whatever depends only on the mesh and on which vertices are
/// constrained (the initial maps, the factored system) is made when it is first needed and kept, so
/// another lambda costs iterations only. Not thread-safe.
class Solver {
 public:
  /// disk and executor must outlive the solver. If constrained has a start, the iterations start
  /// from it, whatever options.initial says.
  Solver(const Disk& disk, const SolveOptions& options, ConstrainedStart constrained,
         Executor& executor);

  /// Moves the same constrained vertices, with the same weights, to other positions. Nothing is
  /// factored again.
  void move(ConstrainedStart constrained);

  /// Solves by options.method. lambda, in options.lambda_units, is read by Method::hybrid only. The
  /// result does not depend on earlier runs. Throws Error{solver_failed, cancelled}.
  Solution run(double lambda, const SolveWatch& watch);

  /// Method::hybrid: descends from a map in which hard constraints hold, silently. Throws
  /// Error{cancelled}.
  Solution run_from(const UvMap& start, double lambda, int max_iterations);

  /// The system of the iterations; null if no run has needed it yet.
  [[nodiscard]] const arap::GlobalStep* global() const { return global_ ? &*global_ : nullptr; }

  /// The disk, the options and the constraints: with lambda, all that run() depends on.
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
///
/// mean_value and tutte have no flipped triangles on a disk of one boundary whose inner edges do
/// not join boundary vertices; lscm may have some. automatic is map_from_rotations(), which may
/// have flips too: it is exact on developable surfaces and elsewhere some ten iterations ahead of
/// the others. If it collapses, automatic is lscm. Solver also tries lscm where that may lower the
/// energy (run_race()); under a given number of iterations, only on disks with several boundaries.
UvMap initial_map(const Disk& disk, InitialMap kind, const arap::GlobalStep& global);

}  // namespace unwrapd::solve
