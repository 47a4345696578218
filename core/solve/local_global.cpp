#include "core/solve/local_global.hpp"

#include <utility>

#include "core/cancel.hpp"

namespace unwrapd {
Solution local_global(const Assembly& assembly, UvMap start, const LocalGlobalOptions& options,
                      const LoopWatch& watch, Executor& executor) {
  Objective objective(assembly.disk, options.rigidity, assembly.holds, executor);
  std::vector<Vec2> step(start.size());  // the force on the map, then the change that it makes
  Solution solution{.uv = std::move(start), .energy = {}};
  solution.energy.push_back(objective.evaluate(solution.uv, step));
  const double least_area = kMinAreaShare * objective.uv_area();
  for (int k = 0; k < options.iterations; ++k) {
    throw_if_cancelled(watch.stop);
    UvMap next = solution.uv;
    assembly.global.solve(step);
    for (std::size_t v = 0; v < next.size(); ++v) next[v] += step[v];
    const double energy = objective.evaluate(next, step);
    if (objective.uv_area() < least_area) {
      solution.stop_reason = StopReason::collapse_guard;
      break;
    }
    solution.uv = std::move(next);
    solution.energy.push_back(energy);
    ++solution.iterations;
    if (watch.on_iteration) watch.on_iteration(solution);
  }
  return solution;
}

}  // namespace unwrapd
