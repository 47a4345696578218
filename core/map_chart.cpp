#include "core/map_chart.hpp"

#include <cmath>
#include <utility>

#include "core/error.hpp"

namespace unwrapd {
namespace {

/// Scales the map to UV area = 3D area in mesh units: all charts then share one texel density.
MappedChart finish(const Disk& disk, const Chart& chart, Solution solution) {
  MappedChart mapped;
  mapped.sums = distortion_sums(disk.rest, disk.faces, solution.uv);
  const double scale = disk.unit * std::sqrt(mapped.sums.area / mapped.sums.uv_area);
  if (!std::isfinite(scale))
    throw Error(ErrorCode::solver_failed,
                "a chart collapsed to zero area; choose another method or initial map");
  for (Vec2& u : solution.uv) u *= scale;
  mapped.report = {.faces = chart.mesh.face_count(),
                   .vertices = chart.mesh.vertex_count(),
                   .boundaries = static_cast<Index>(chart.loops.size()),
                   .area = disk.unit * disk.unit * mapped.sums.area,
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

std::vector<std::vector<MappedChart>> map_chart(const Chart& chart, const UnwrapOptions& options,
                                                ChartWatch& watch, Executor& executor) {
  const std::vector<double> lambdas = lambdas_of(options);
  watch.begin_chart(chart.mesh.faces.size(), lambdas.size());
  const Disk disk = make_disk(chart.mesh, chart.loops);
  Solver solver(disk, options, {}, executor);
  std::vector<std::vector<MappedChart>> maps(lambdas.size());
  for (std::size_t k = 0; k < lambdas.size(); ++k) {
    watch.begin_run(is_curve(options) ? std::optional(lambdas[k]) : std::nullopt);
    Solution solution = solver.run(lambdas[k], watch.solve_watch(disk, options.stop));
    maps[k].push_back(finish(disk, chart, std::move(solution)));
    watch.end_run();
  }
  watch.end_chart();
  return maps;
}

}  // namespace unwrapd
