#include "core/solve/local_global.hpp"

#include <utility>

#include "core/error.hpp"
#include "core/measure/distortion.hpp"

namespace unwrapd {
namespace {

/// The state that one iteration hands to the next: the residual belongs to solution.uv.
class Iteration {
 public:
  Iteration(const Disk& disk, const Rigidity& rigidity, Executor& executor)
      : disk_(disk), rigidity_(rigidity), executor_(executor), residual_(3 * disk.faces.size()) {}

  double fit(const UvMap& uv) {
    return local_step({disk_.rest, disk_.faces}, uv, rigidity_, residual_, executor_);
  }
  void stitch(const GlobalStep& global, UvMap& uv) { global.advance(residual_, uv, executor_); }

 private:
  const Disk& disk_;
  Rigidity rigidity_;
  Executor& executor_;
  std::vector<Vec2> residual_;
};

}  // namespace

Solution local_global(const GlobalStep& global, UvMap start, const LocalGlobalOptions& options,
                      const LoopWatch& watch, Executor& executor) {
  const Disk& disk = global.disk();
  Iteration iteration(disk, options.rigidity, executor);
  Solution solution{.uv = std::move(start), .energy = {}};
  solution.energy.push_back(iteration.fit(solution.uv));
  const double least_area = kMinAreaShare * uv_area(disk.rest, disk.faces, solution.uv);
  for (int k = 0; k < options.iterations; ++k) {
    if (watch.stop.stop_requested()) throw Error(ErrorCode::cancelled, "the job was cancelled");
    UvMap next = solution.uv;
    iteration.stitch(global, next);
    if (uv_area(disk.rest, disk.faces, next) < least_area) {
      solution.stop_reason = StopReason::collapse_guard;
      break;
    }
    solution.uv = std::move(next);
    solution.energy.push_back(iteration.fit(solution.uv));
    ++solution.iterations;
    if (watch.on_iteration) watch.on_iteration(solution);
  }
  return solution;
}

}  // namespace unwrapd
