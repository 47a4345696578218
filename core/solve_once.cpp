#include "core/solve_once.hpp"

#include <array>
#include <memory>
#include <utility>

#include "core/solve/kept.hpp"

namespace unwrapd {
namespace {

struct Run {
  Solution solution;
  std::vector<IterationEvent> told;
};

std::size_t bytes_of(const Run& run) {
  using unwrapd::bytes_of;
  return sizeof(Run) + bytes_of(run.solution.uv) + bytes_of(run.solution.energy) +
         bytes_of(run.told);
}

/// Everything that a run without held vertices depends on.
Digest digest_of(const ChartJob& job, const UnwrapOptions& options, double lambda,
                 bool is_followed) {
  const Stop& stop = options.stop;
  const bool has_lambda = options.method == Method::hybrid;
  const std::array<int, 7> choices{static_cast<int>(options.method),
                                   static_cast<int>(options.lambda_units),
                                   static_cast<int>(options.initial),
                                   static_cast<int>(options.pins),
                                   stop.iterations.value_or(0),  // it is never 0
                                   stop.max_iterations,
                                   is_followed ? 1 : 0};
  const std::array<double, 3> numbers{has_lambda ? lambda : 0, stop.tolerance, job.disk.unit};
  Content content("run");
  content.add(choices).add(numbers).add(job.disk.content).add(job.chart->start);
  for (const BoundaryLoop& loop : job.disk.loops) content.add(loop);
  return job.disk.core->digest(content);
}

}  // namespace

Solution solve_once(Solver& solver, const ChartJob& job, const UnwrapOptions& options,
                    double lambda, const ChartWatch& watch) {
  bool is_new = false;
  const auto run = [&] {
    auto made = std::make_shared<Run>();
    made->solution = solver.run(lambda, watch.solve_watch(job.disk, options.stop, made->told));
    is_new = true;
    return made;
  };
  if (job.disk.core == nullptr || !job.page.empty() || options.boundary != BoundaryShape::free)
    return std::move(run()->solution);
  const auto make = [&]() -> SolverCore::Made {
    const std::shared_ptr<const Run> made = run();
    return {made, bytes_of(*made)};
  };
  const auto found = std::static_pointer_cast<const Run>(job.disk.core->obtain(
      digest_of(job, options, lambda, watch.is_followed()), make, watch.stop()));
  if (!is_new) watch.tell_again(found->told, options.stop);
  return found->solution;
}

}  // namespace unwrapd
