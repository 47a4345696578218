#pragma once
// One chart, one method: ASAP directly, ARAP and Hybrid by local/global iterations.

#include <functional>

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

/// The map that the iterations start from, scaled so that UV area = 3D area. automatic: for one
/// boundary mean_value or lscm, whichever has less ARAP energy; lscm for several (Sec. 4.5).
UvMap initial_map(const Disk& disk, InitialMap kind);

}  // namespace unwrapd
