#include "core/segment/whole_chart.hpp"

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/overlaps.hpp"
#include "core/segment/segment.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kWholeTolerance = 1e-3;  // of energy: what solving on gains is within the margin
constexpr int kMostIterations = 100;

UvMap arap_map(const solve::Disk& disk, Executor& executor, const std::stop_token& stop) {
  UnwrapOptions options;
  options.stop.tolerance = kWholeTolerance;
  options.stop.max_iterations = kMostIterations;
  solve::Solver solver(disk, options, {}, executor);
  solve::SolveWatch watch;
  watch.loop.stop = stop;
  return solver.run(0, watch).uv;
}

}  // namespace

std::optional<UvMap> map_whole(const charts::Chart& disk, double max_distortion, Executor& executor,
                               const std::stop_token& stop) try {
  const solve::Disk own = solve::make_disk(disk.mesh, disk.loops, stop);
  UvMap uv = arap_map(own, executor, stop);
  const measure::DistortionSums sums = measure::distortion_sums(own.rest, own.faces, uv, executor);
  const double most = kMarginOfExcess * (max_distortion - 2) * sums.measured;
  if (sums.flipped > 0 || !(excess_of(sums).worst() <= most)) return std::nullopt;
  if (!measure::is_plainly_injective(own.faces, own.loops, uv, stop)) return std::nullopt;
  return uv;
} catch (const Error& error) {  // too ill-conditioned: its parts may be better
  if (error.code() != ErrorCode::solver_failed) throw;
  return std::nullopt;
}

}  // namespace unwrapd::segment
