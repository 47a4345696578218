#pragma once
// The local/global iteration of Secs. 4.4 and 5: fit every triangle, solve for the map, repeat.

#include "core/solve/arap/global_step.hpp"
#include "core/solve/arap/objective.hpp"
#include "core/solve/base/solution.hpp"

namespace unwrapd::solve::arap {

/// A disk, its constraints, and the system that was factored for both.
struct Assembly {
  const Disk& disk;
  const VertexConstraints& constraints;
  const GlobalStep& global;
};

struct LocalGlobalOptions {
  Rigidity rigidity;
  int iterations = 10;
};

/// Runs unaccelerated iterations from the map start, in which hard constraints hold. The energy
/// never rises. A step that would leave less than kMinAreaShare of the start's UV area is rejected
/// and ends the run (collapse_guard). Throws Error{cancelled} within one iteration of a stop
/// request.
Solution local_global(const Assembly& assembly, const UvMap& start,
                      const LocalGlobalOptions& options, const LoopWatch& watch,
                      Executor& executor);

inline constexpr double kMinAreaShare = 0.01;

}  // namespace unwrapd::solve::arap
