#include "core/pipeline/solve_once.hpp"

#include <cassert>

#include "core/solve/base/kept.hpp"

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

/// What a run tells of itself while it goes on.
struct Running : Making {
  const ChartJob& job;
  const Stop& stop_rule;
  const ChartWatch& watch;
  bool& is_new;
};

/// is_followed: whether the watch asks for what a run tells, which is not noted otherwise.
Run run_once(const Running& by, Solver& solver, double lambda, [[maybe_unused]] bool is_followed) {
  assert(is_followed == by.watch.is_followed());
  Run made;
  by.is_new = true;
  made.solution = solver.run(lambda, by.watch.solve_watch(by.job.disk, by.stop_rule, made.told));
  return made;
}

}  // namespace

Solution solve_once(Solver& solver, const ChartJob& job, const UnwrapOptions& options,
                    double lambda, const ChartWatch& watch) {
  bool is_new = false;
  const bool comes_twice = job.page.empty() && options.boundary == BoundaryShape::free;
  const Running by{
      {comes_twice ? job.disk.core : nullptr, watch.stop()}, job, options.stop, watch, is_new};
  const double read = options.method == Method::hybrid ? lambda : 0;
  const auto found = kept<run_once>(by, solver, read, watch.is_followed());
  if (!is_new) watch.tell_again(found->told, options.stop);
  return found->solution;
}

}  // namespace unwrapd
