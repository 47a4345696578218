#pragma once
// The result of solving a chart, and the callbacks while it is solved.

#include <functional>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/progress.hpp"
#include "core/types/report.hpp"

namespace unwrapd::solve {

/// A chart's map. uv is in disk units (the surface has area 1). Energies are divided by the surface
/// area and are therefore dimensionless.
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

/// Callbacks and the stop of a solve.
struct SolveWatch {
  std::function<void(Stage)> on_stage;  ///< setup, factor, solve
  LoopWatch loop;
};

}  // namespace unwrapd::solve
