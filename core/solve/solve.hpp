#pragma once
// One chart, one method: ASAP directly, ARAP and Hybrid by local/global iterations.

#include <functional>
#include <optional>
#include <vector>

#include "core/options.hpp"
#include "core/progress.hpp"
#include "core/solve/conformal_system.hpp"
#include "core/solve/local_global.hpp"

namespace unwrapd {

/// What a caller may watch while a chart is solved.
struct SolveWatch {
  std::function<void(Stage)> on_stage;  ///< setup, factor, solve
  LoopWatch loop;
};

/// One disk under one set of options. What depends on the mesh and on which vertices are held (the
/// initial maps, the factored system) is made when it is first needed and kept: another lambda
/// costs iterations only. Used by one thread at a time.
class Solver {
 public:
  /// disk, options and executor must outlive the solver. Under holds the iterations start from
  /// held.start, whatever options.initial says.
  Solver(const Disk& disk, const UnwrapOptions& options, Held held, Executor& executor);

  /// Holds the same vertices, with the same weights, at other places: nothing is factored again.
  void move(Held held);

  /// Solves by options.method; lambda counts for Method::hybrid, in options.lambda_units. The same
  /// whatever was run before. Throws Error{solver_failed, cancelled}.
  Solution run(double lambda, const SolveWatch& watch);

 private:
  const std::vector<UvMap>& starts();
  const UvMap& conformal();
  UvMap conformal_under_holds();
  Solution hybrid(const Rigidity& rigidity, const SolveWatch& watch);
  Solution iterate(const Rigidity& rigidity, const std::vector<UvMap>& starts,
                   const SolveWatch& watch);

  const Disk& disk_;
  const UnwrapOptions& options_;
  Holds holds_;
  UvMap held_start_;
  Executor& executor_;
  std::vector<UvMap> starts_;
  std::optional<UvMap> conformal_;
  std::optional<GlobalStep> global_;
  std::optional<ConformalSystem> conformal_system_;
};

/// The maps that the iterations may start from, each scaled so that UV area = 3D area. One, but for
/// automatic on one boundary: mean_value, and lscm where it is exact; Solver then takes the one
/// from which a few iterations get farthest. automatic on several boundaries: lscm (Sec. 4.5).
std::vector<UvMap> initial_maps(const Disk& disk, InitialMap kind);

}  // namespace unwrapd
