#include "core/map_chart.hpp"

#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "core/solve/hold_page.hpp"

namespace unwrapd {
namespace {

/// Sums in disk units as they are in mesh units, scale UV units in one disk unit.
DistortionSums in_mesh_units(DistortionSums sums, double unit, double scale) {
  sums.area *= unit * unit;
  sums.uv_area *= scale * scale;
  sums.angle *= unit * unit;
  sums.inverse *= unit * unit * (unit / scale) * (unit / scale);
  sums.stretch *= unit * unit * (unit / scale) * (unit / scale);
  return sums;
}

/// Scales a free map to UV area = 3D area in mesh units: all charts then share one texel density.
/// One under position constraints goes to its place on the page.
MappedChart finish(const Disk& disk, const Chart& chart, const ChartHold& hold, Solution solution) {
  MappedChart mapped;
  const DistortionSums own = distortion_sums(disk.rest, disk.faces, solution.uv);
  const double even = std::sqrt(own.area / own.uv_area);
  if (!std::isfinite(even))
    throw Error(ErrorCode::solver_failed,
                "a chart collapsed to zero area; choose another method or initial map");
  const PageFrame frame = hold.frame.value_or(PageFrame{Vec2::Zero(), disk.unit * even});
  solution.uv = frame.to_page(std::move(solution.uv), hold.page);
  mapped.sums = in_mesh_units(own, disk.unit, frame.scale);
  mapped.report = {.faces = chart.mesh.face_count(),
                   .vertices = chart.mesh.vertex_count(),
                   .boundaries = static_cast<Index>(chart.loops.size()),
                   .area = mapped.sums.area,
                   .distortion = distortion(mapped.sums),
                   .iterations = solution.iterations,
                   .stop_reason = solution.stop_reason,
                   .energy = std::move(solution.energy)};
  mapped.uv = std::move(solution.uv);
  mapped.chart = chart;
  return mapped;
}

}  // namespace

bool is_curve(const UnwrapOptions& options) {
  return options.method == Method::hybrid && !options.lambda_curve.empty();
}

std::vector<double> lambdas_of(const UnwrapOptions& options) {
  return is_curve(options) ? options.lambda_curve : std::vector{options.lambda};
}

std::vector<std::vector<MappedChart>> map_chart(const ChartJob& job, const UnwrapOptions& options,
                                                ChartWatch& watch, Executor& executor) {
  const Chart& chart = job.chart;
  const std::vector<double> lambdas = lambdas_of(options);
  watch.begin_chart(chart.mesh.faces.size(), lambdas.size());
  const Disk disk = make_disk(chart.mesh, chart.loops);
  const ChartHold hold = hold_chart(disk, options, job.page, watch.stop(), executor);
  Solver solver(disk, options, hold.held, executor);
  std::vector<std::vector<MappedChart>> maps(lambdas.size());
  for (std::size_t k = 0; k < lambdas.size(); ++k) {
    watch.begin_run(is_curve(options) ? std::optional(lambdas[k]) : std::nullopt);
    Solution solution = solver.run(lambdas[k], watch.solve_watch(disk, options.stop));
    maps[k].push_back(finish(disk, chart, hold, std::move(solution)));
    watch.end_run();
  }
  watch.end_chart();
  return maps;
}

}  // namespace unwrapd
