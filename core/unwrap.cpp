// The whole of core at a glance: surfaces are taken apart into charts, each chart is mapped, all
// are packed on one page, and the page's UVs are measured and put back on the surfaces.
#include "core/unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/atlas/charts.hpp"
#include "core/atlas/pack.hpp"
#include "core/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/seam_length.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd {
namespace {

/// Shares of the job that are behind us when a step of core begins; reading comes before, writing
/// after.
constexpr double kChartsBegin = 0.05, kSolveBegin = 0.10, kPackBegin = 0.90, kMeasureBegin = 0.93;

/// One chart on its way through the pipeline.
struct MappedChart {
  UvMap uv;             ///< in mesh units, UV area = 3D area
  DistortionSums sums;  ///< of that map
  ChartReport report;
};

void announce(const Progress& progress, const StageEvent& event) {
  if (progress.on_stage) progress.on_stage(event);
}

std::vector<Charts> take_apart(std::span<const Surface> surfaces, SeamMode seams) {
  const auto is_empty = [](const Surface& surface) { return surface.mesh.faces.empty(); };
  if (std::all_of(surfaces.begin(), surfaces.end(), is_empty))
    throw Error(ErrorCode::no_triangles, "the asset has no triangles; there is nothing to unwrap");
  std::vector<Charts> parts;
  parts.reserve(surfaces.size());
  for (const Surface& surface : surfaces) parts.push_back(make_charts(surface, seams));
  return parts;
}

/// Where a chart stands among all, and what it may tell about itself.
class ChartWatch {
 public:
  ChartWatch(const Progress& progress, Index chart_count, std::size_t face_count)
      : progress_(progress),
        chart_count_(chart_count),
        faces_total_(static_cast<double>(std::max<std::size_t>(face_count, 1))) {}

  SolveWatch watch(const Disk& disk, int iterations) const {
    SolveWatch watch;
    watch.loop.stop = progress_.stop;
    watch.on_stage = [this](Stage stage) {
      announce(progress_, {stage, chart_, chart_count_, fraction(0)});
    };
    if (progress_.on_iteration)
      watch.loop.on_iteration = [this, &disk, iterations](const Solution& s) {
        progress_.on_iteration(describe(disk, s, iterations));
      };
    return watch;
  }

  void begin(std::size_t faces) { faces_now_ = static_cast<double>(faces); }
  void end() {
    ++chart_;
    faces_done_ += std::exchange(faces_now_, 0);
  }

 private:
  double fraction(double of_chart) const {
    const double done = (faces_done_ + of_chart * faces_now_) / faces_total_;
    return kSolveBegin + (kPackBegin - kSolveBegin) * done;
  }

  IterationEvent describe(const Disk& disk, const Solution& s, int iterations) const {
    const Distortion d = distortion(distortion_sums(disk.rest, disk.faces, s.uv));
    const double before = s.energy[s.energy.size() - 2], now = s.energy.back();
    return {.chart = chart_,
            .iteration = s.iterations,
            .energy = now,
            .rel_change = before > 0 ? (before - now) / before : 0,
            .angle = d.angle,
            .area = d.area,
            .flipped = d.flipped,
            .fraction = fraction(static_cast<double>(s.iterations) / iterations)};
  }

  const Progress& progress_;
  Index chart_ = 0, chart_count_;
  double faces_total_, faces_done_ = 0, faces_now_ = 0;
};

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
  return mapped;
}

std::vector<MappedChart> map_charts(const std::vector<Charts>& parts, const UnwrapOptions& options,
                                    const Progress& progress, Executor& executor) {
  std::size_t chart_count = 0, face_count = 0;
  for (const Charts& part : parts) {
    chart_count += part.charts.size();
    for (const Chart& chart : part.charts) face_count += chart.mesh.faces.size();
  }
  if (chart_count == 0)
    throw Error(ErrorCode::zero_area, "every triangle has zero area; there is nothing to unwrap");

  ChartWatch watch(progress, static_cast<Index>(chart_count), face_count);
  std::vector<MappedChart> mapped;
  mapped.reserve(chart_count);
  for (std::size_t s = 0; s < parts.size(); ++s)
    for (const Chart& chart : parts[s].charts) {
      if (progress.stop.stop_requested())
        throw Error(ErrorCode::cancelled, "the job was cancelled");
      watch.begin(chart.mesh.faces.size());
      const Disk disk = make_disk(chart.mesh, chart.loops);
      Solver solver(disk, options, {}, executor);
      const int most = options.stop.iterations.value_or(options.stop.max_iterations);
      mapped.push_back(finish(disk, chart, solver.run(options.lambda, watch.watch(disk, most))));
      mapped.back().report.surface = static_cast<Index>(s);
      watch.end();
    }
  return mapped;
}

/// Places every chart on the page; the maps become page UVs. Returns the common scale.
double place(std::vector<UvMap>& islands, const UnwrapOptions& options) {
  const std::vector<Placement> placements = pack(islands, {options.resolution, options.padding});
  for (std::size_t c = 0; c < islands.size(); ++c)
    for (Vec2& u : islands[c]) u = placements[c](u);
  return placements.front().scale;
}

Report describe(const std::vector<Charts>& parts, const std::vector<MappedChart>& mapped) {
  Report report;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const InputReport& in = parts[s].input;
    report.input.faces += in.faces;
    report.input.vertices += in.vertices;
    report.input.components += in.components;
    report.input.boundaries += in.boundaries;
    report.input.genus += in.genus;
    report.input.welded = report.input.welded || in.welded;
    for (Repair repair : parts[s].repairs) {
      repair.surface = static_cast<Index>(s);
      report.repairs.push_back(repair);
    }
  }
  DistortionSums sums;
  for (const MappedChart& chart : mapped) {
    report.charts.push_back(chart.report);
    DistortionSums own = chart.sums;  // in units of the chart's own area; all share one density
    own.angle *= chart.report.area / own.area;
    own.inverse *= own.uv_area / own.area * chart.report.area / own.area;
    own.stretch *= own.uv_area / own.area * chart.report.area / own.area;
    own.area = own.uv_area = chart.report.area;
    sums += own;
  }
  report.distortion = distortion(sums);
  return report;
}

}  // namespace

Unwrapped unwrap(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  validate(options, std::numeric_limits<int>::max());
  announce(progress, {Stage::setup, 0, 0, kChartsBegin});
  const std::vector<Charts> parts = take_apart(surfaces, options.seams);
  std::vector<MappedChart> mapped = map_charts(parts, options, progress, executor);
  const auto chart_count = static_cast<Index>(mapped.size());

  announce(progress, {Stage::pack, 0, chart_count, kPackBegin});
  Unwrapped unwrapped;
  unwrapped.report = describe(parts, mapped);
  std::vector<UvMap> islands;
  islands.reserve(mapped.size());
  for (MappedChart& chart : mapped) islands.push_back(std::move(chart.uv));
  const double scale = place(islands, options);

  announce(progress, {Stage::measure, 0, chart_count, kMeasureBegin});
  std::size_t first = 0;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const auto own = std::span(islands).subspan(first, parts[s].charts.size());
    unwrapped.surfaces.push_back(assemble(surfaces[s], parts[s], own));
    unwrapped.report.seam_length += seam_length(surfaces[s], unwrapped.surfaces.back());
    first += own.size();
  }
  for (const ChartReport& chart : unwrapped.report.charts)
    unwrapped.report.fill += chart.area * scale * scale;
  unwrapped.report.texel_density = scale * options.resolution;
  return unwrapped;
}

}  // namespace unwrapd
