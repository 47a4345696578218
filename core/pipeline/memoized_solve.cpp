#include "core/pipeline/memoized_solve.hpp"

#include <cassert>

#include "core/solve/base/cached.hpp"

namespace unwrapd::pipeline {
namespace {

struct Run {
  solve::Solution solution;
  std::vector<IterationEvent> told;
};

std::size_t bytes_of(const Run& run) {
  using unwrapd::solve::bytes_of;
  return sizeof(Run) + solve::bytes_of(run.solution.uv) + solve::bytes_of(run.solution.energy) +
         solve::bytes_of(run.told);
}

/// What a run tells of itself while it goes on.
struct Running : solve::Making {
  const ChartJob& job;
  const Stop& stop_rule;
  const ChartProgress& watch;
  bool& is_new;
};

/// is_followed: whether the watch asks for what a run tells, which is not noted otherwise.
Run run_once(const Running& by, solve::Solver& solver, double lambda,
             [[maybe_unused]] bool is_followed) {
  assert(is_followed == by.watch.is_followed());
  Run made;
  by.is_new = true;
  made.solution = solver.run(lambda, by.watch.solve_watch(by.job.disk, by.stop_rule, made.told));
  return made;
}

}  // namespace

solve::Solution memoized_solve(solve::Solver& solver, const ChartJob& job,
                               const UnwrapOptions& options, double lambda,
                               const ChartProgress& watch) {
  bool is_new = false;
  const bool comes_twice = job.page.empty() && options.boundary == BoundaryShape::free;
  const Running by{
      {comes_twice ? job.disk.core : nullptr, watch.stop()}, job, options.stop, watch, is_new};
  const double read = options.method == Method::hybrid ? lambda : 0;
  const auto found = solve::cached<run_once>(by, solver, read, watch.is_followed());
  if (!is_new) watch.tell_again(found->told, options.stop);
  return found->solution;
}

}  // namespace unwrapd::pipeline
