#pragma once
// What a method makes of a chart, and what may be watched while it does.

#include <functional>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/progress.hpp"
#include "core/types/report.hpp"

namespace unwrapd::solve {

/// A chart's map. uv is in disk units (the surface has area 1); energies are divided by the surface
/// area and hence without unit.
struct Solution {
  UvMap uv;
  std::vector<double> energy;  ///< energy[0] of the start, energy[k] after iteration k
  int iterations = 0;
  StopReason stop_reason = StopReason::iterations;
};

struct LoopWatch {
  std::function<void(const Solution&)>
      on_iteration;  ///< after every iteration: the solution so far
  std::stop_token stop;
};

/// What a caller may watch while a chart is solved.
struct SolveWatch {
  std::function<void(Stage)> on_stage;  ///< setup, factor, solve
  LoopWatch loop;
};

}  // namespace unwrapd::solve
