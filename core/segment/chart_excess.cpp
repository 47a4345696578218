// The solver itself is the judge, stopped early: what it still gains from there is small beside
// what noise adds. Flips that are left are mended later, and would count without measure here.
#include "core/segment/chart_excess.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kTolerance = 1e-2;         // of energy, from iteration to iteration
constexpr double kLeastDeterminant = 0.01;  // of a face that counts; of the whole chart it is 1

UvMap moved_on(const solve::Disk& disk, Executor& executor, const UvMap& start) {
  UnwrapOptions options;
  options.stop.tolerance = kTolerance;
  solve::Solver solver(disk, options, {{}, solve::with_unit_area(disk, start, executor)}, executor);
  solve::SolveWatch watch;
  watch.loop.stop = disk.stop;
  return solver.run(0, watch).uv;
}

/// In mesh units.
ExcessDistortion excess_in(const solve::Disk& disk, const UvMap& uv, Executor& executor) {
  std::vector<measure::RestTriangle> rest;
  std::vector<Triangle> faces;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    if (!(measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv)).determinant() >
          kLeastDeterminant))
      continue;
    rest.push_back(disk.rest[t]);
    faces.push_back(disk.faces[t]);
  }
  if (faces.empty()) return {};
  const ExcessDistortion own = excess_of(measure::distortion_sums(rest, faces, uv, executor));
  const double scale = disk.unit * disk.unit;
  return {scale * own.angle, scale * own.area};
}

/// In mesh units; none where the chart cannot be factored.
ExcessDistortion excess_of_one(const charts::Chart& chart, Executor& executor,
                               const std::stop_token& stop) {
  try {
    throw_if_cancelled(stop);
    const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops, stop);
    return excess_in(disk, moved_on(disk, executor, chart.start), executor);
  } catch (const Error&) {
    throw_if_cancelled(stop);
    return {};
  }
}

}  // namespace

ChartExcess chart_excess(std::span<const charts::Chart> charts, Executor& executor,
                         const std::stop_token& stop) {
  ChartExcess excess;
  double area = 0;
  for (const charts::Chart& chart : charts) {
    const ExcessDistortion own = excess_of_one(chart, executor, stop);
    const double own_area = measure::surface_area(chart.mesh);
    excess.of_each.push_back(own_area > 0 ? own.worst() / own_area : 0);
    excess.mean += own;
    area += own_area;
  }
  excess.mean = {excess.mean.angle / area, excess.mean.area / area};
  return excess;
}

}  // namespace unwrapd::segment
