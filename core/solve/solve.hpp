#pragma once
// One chart, one method: ASAP directly, ARAP and Hybrid by local/global iterations.

#include <functional>
#include <vector>

#include "core/options.hpp"
#include "core/progress.hpp"
#include "core/solve/local_global.hpp"

namespace unwrapd {

/// What a caller may watch while a chart is solved.
struct SolveWatch {
  std::function<void(Stage)> on_stage;  ///< setup, factor, solve
  LoopWatch loop;
};

/// Solves one disk. Throws Error{solver_failed, cancelled}.
Solution solve(const Disk& disk, const UnwrapOptions& options, const SolveWatch& watch,
               Executor& executor);

/// The maps that the iterations may start from, each scaled so that UV area = 3D area. One, but for
/// automatic on one boundary: mean_value, and lscm where it is exact; solve() then takes the one
/// from which a few iterations get farthest. automatic on several boundaries: lscm (Sec. 4.5).
std::vector<UvMap> initial_maps(const Disk& disk, InitialMap kind);

}  // namespace unwrapd
