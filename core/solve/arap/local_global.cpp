#include "core/solve/arap/local_global.hpp"

#include "core/base/cancel.hpp"

namespace unwrapd::solve::arap {
Solution local_global(const Assembly& assembly, const UvMap& start,
                      const LocalGlobalOptions& options, const LoopWatch& watch,
                      Executor& executor) {
  const std::span<const Index> rank = assembly.global.rank();
  Objective objective(assembly.disk, options.rigidity, assembly.constraints, rank, executor);
  UvMap uv = by_rank(start, rank), next(uv.size());
  std::vector<Vec2> step(uv.size());  // the force on the map, then the change that it makes
  Solution solution;
  solution.energy.push_back(objective.evaluate(uv, step));
  const double least_area = kMinAreaShare * objective.uv_area();
  for (int k = 0; k < options.iterations; ++k) {
    throw_if_cancelled(watch.stop);
    assembly.global.solve_by_rank(step);
    for (std::size_t v = 0; v < next.size(); ++v) next[v] = uv[v] + step[v];
    const double energy = objective.evaluate(next, step);
    if (objective.uv_area() < least_area) {
      solution.stop_reason = StopReason::collapse_guard;
      break;
    }
    uv.swap(next);
    solution.energy.push_back(energy);
    ++solution.iterations;
    if (!watch.on_iteration) continue;
    solution.uv = by_vertex(uv, rank);
    watch.on_iteration(solution);
  }
  solution.uv = by_vertex(uv, rank);
  return solution;
}

}  // namespace unwrapd::solve::arap
