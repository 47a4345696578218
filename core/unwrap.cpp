// The whole of core at a glance: surfaces are taken apart into charts, each chart is mapped, all
// are packed on one page, and the page's UVs are measured and put back on the surfaces.
#include "core/unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/atlas/constraints.hpp"
#include "core/atlas/outline.hpp"
#include "core/atlas/pack.hpp"
#include "core/atlas/promise.hpp"
#include "core/atlas/segment_charts.hpp"
#include "core/error.hpp"
#include "core/map_chart.hpp"
#include "core/measure/seam_length.hpp"
#include "core/place_islands.hpp"
#include "core/repack.hpp"
#include "core/solver_core.hpp"

namespace unwrapd {
namespace {

/// Shares of the job that are behind us when a step of core begins; reading comes before, writing
/// after.
constexpr double kChartsBegin = 0.05, kPackBegin = kSolveEnd, kMeasureBegin = 0.93;
constexpr double kSegmentEnd = 0.50;  // where something is segmented

/// All charts under one map: what goes on one page.
struct Layout {
  std::vector<Charts> surfaces;             ///< with the charts as mapped
  std::vector<std::vector<UvMap>> islands;  ///< islands[s][k]: the map of chart k of surface s
  std::vector<std::vector<std::vector<char>>> held;  ///< held[s][k]: see MappedChart
  DistortionSums sums;                               ///< of all charts, in mesh units
  Report report;
};

void announce(const Progress& progress, Stage stage, std::size_t charts, double fraction) {
  if (progress.on_stage) progress.on_stage({stage, 0, static_cast<Index>(charts), fraction});
}

/// The charts of a job, and where their solving begins in it.
struct Taken {
  std::vector<Charts> parts;
  double solve_begin = kSolveBegin;
  std::string note;
};

/// Constraints and boundary shapes are about whole components.
SegmentOptions segment_options(const UnwrapOptions& options) {
  return {
      .max_distortion = options.max_distortion,
      .max_charts = options.max_charts,
      .one_chart_each = !options.constraints.empty() || options.boundary != BoundaryShape::free};
}

std::vector<Charts> components(std::span<const Surface> surfaces, const UnwrapOptions& options,
                               const std::stop_token& stop) {
  const auto is_empty = [](const Surface& surface) { return surface.mesh.faces.empty(); };
  if (std::all_of(surfaces.begin(), surfaces.end(), is_empty))
    throw Error(ErrorCode::no_triangles, "the asset has no triangles; there is nothing to unwrap");
  std::vector<Charts> parts;
  parts.reserve(surfaces.size());
  for (const Surface& surface : surfaces)
    parts.push_back(components_of(
        surface, {options.seams, options.seam_edges, static_cast<Index>(parts.size()), stop}));
  return parts;
}

void check_memory(std::span<const Surface> surfaces, const SolverCore* core) {
  std::size_t faces = 0;
  for (const Surface& surface : surfaces) faces += surface.mesh.faces.size();
  if (core != nullptr) check_memory(*core, kJobBytesPerFace * faces);
}

Taken take_apart(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  Taken taken{components(surfaces, options, progress.stop), kSolveBegin, {}};
  const auto on_progress = [&](Stage stage, double share) {
    taken.solve_begin = kSegmentEnd;
    announce(progress, stage, 0, kChartsBegin + (kSegmentEnd - kChartsBegin) * share);
  };
  taken.note =
      segment_charts(taken.parts, segment_options(options), {on_progress, progress.stop}, executor);
  return taken;
}

void add_input(Report& report, const Charts& part, Index surface) {
  report.input.faces += part.input.faces;
  report.input.vertices += part.input.vertices;
  report.input.components += part.input.components;
  report.input.boundaries += part.input.boundaries;
  report.input.genus += part.input.genus;
  report.input.welded = report.input.welded || part.input.welded;
  for (Repair repair : part.repairs) {
    repair.surface = surface;
    report.repairs.push_back(repair);
  }
}

/// A page for each map: what came in is in its report, charts are not in it yet.
std::vector<Layout> empty_layouts(const std::vector<Charts>& parts, std::size_t map_count) {
  Layout layout;
  layout.islands.resize(parts.size());
  layout.held.resize(parts.size());
  for (std::size_t s = 0; s < parts.size(); ++s) {
    add_input(layout.report, parts[s], static_cast<Index>(s));
    layout.surfaces.push_back({.charts = {},
                               .set_aside = parts[s].set_aside,
                               .repeats = parts[s].repeats,
                               .input = parts[s].input,
                               .repairs = {}});
  }
  return {map_count, layout};
}

void add_chart(Layout& layout, std::size_t surface, MappedChart mapped) {
  mapped.report.surface = static_cast<Index>(surface);
  layout.sums += mapped.sums;
  layout.report.charts.push_back(std::move(mapped.report));
  layout.surfaces[surface].charts.push_back(std::move(mapped.chart));
  layout.islands[surface].push_back(std::move(mapped.uv));
  layout.held[surface].push_back(std::move(mapped.held));
}

ChartWatch chart_watch(const Taken& taken, const Progress& progress) {
  std::size_t chart_count = 0, face_count = 0;
  for (const Charts& part : taken.parts) {
    chart_count += part.charts.size();
    for (const Chart& chart : part.charts) face_count += chart.mesh.faces.size();
  }
  if (chart_count == 0)
    throw Error(ErrorCode::zero_area, "every triangle has zero area; there is nothing to unwrap");
  return {progress, static_cast<Index>(chart_count), face_count, taken.solve_begin};
}

/// page: the position constraints of every chart of every surface.
std::vector<Layout> map_charts(const Taken& taken, const std::vector<std::vector<Holds>>& page,
                               const UnwrapOptions& options, const Progress& progress,
                               Executor& executor) {
  const std::vector<Charts>& parts = taken.parts;
  ChartWatch watch = chart_watch(taken, progress);
  std::vector<Layout> layouts = empty_layouts(parts, lambdas_of(options).size());
  if (!taken.note.empty())
    for (Layout& layout : layouts) layout.report.notes.push_back(taken.note);
  for (std::size_t s = 0; s < parts.size(); ++s)
    for (std::size_t c = 0; c < parts[s].charts.size(); ++c) {
      auto maps = map_chart({parts[s].charts[c], page[s][c]}, options, watch, executor);
      for (std::size_t k = 0; k < maps.size(); ++k)
        for (MappedChart& mapped : maps[k]) add_chart(layouts[k], s, std::move(mapped));
    }
  for (Layout& layout : layouts) layout.report.distortion = distortion(layout.sums);
  return layouts;
}

/// Places every chart on the page; the maps become page UVs. Returns their common scale.
double place(Layout& layout, const UnwrapOptions& options, const std::stop_token& stop) {
  std::vector<Outline> outlines;
  std::vector<UvMap*> maps;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k) {
      outlines.push_back(outline_of(layout.surfaces[s].charts[k], layout.islands[s][k]));
      maps.push_back(&layout.islands[s][k]);
    }
  return place_islands(outlines, options, stop, maps, layout.report);
}

/// Says where constraints reach beyond the page.
void note_charts_beyond(Layout& layout) {
  const auto is_beyond = [](const Vec2& u) { return u.minCoeff() < 0 || u.maxCoeff() > 1; };
  std::ptrdiff_t count = 0;
  for (const std::vector<UvMap>& own : layout.islands)
    count += std::count_if(own.begin(), own.end(), [&](const UvMap& uv) {
      return std::any_of(uv.begin(), uv.end(), is_beyond);
    });
  if (count > 0)
    layout.report.notes.push_back("The constraints put " + std::to_string(count) +
                                  " of the charts partly or wholly outside the page.");
}

/// Charts under position constraints are on the page already.
void lay_out_page(Layout& layout, const UnwrapOptions& options, const std::stop_token& stop) {
  layout.report.fill = layout.sums.uv_area;
  const double scale = options.constraints.empty() ? place(layout, options, stop) : 1;
  const double density = std::sqrt(layout.sums.uv_area / layout.sums.area);
  layout.report.texel_density = scale * density * options.resolution;
  if (!options.constraints.empty()) note_charts_beyond(layout);
}

/// The promise kept in what is written; the report tells what is true there.
void keep_on_page(Layout& layout, const UnwrapOptions& options, const std::stop_token& stop) {
  auto report = layout.report.charts.begin();
  layout.report.guarantee = options.guarantee;
  layout.report.distortion.flipped = 0;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      Promise promise{.guarantee = options.guarantee};
      promise.intent = {.rigidity = {}, .held = layout.held[s][k], .stop = stop};
      const Written written =
          keep_on_page(layout.surfaces[s].charts[k], promise, layout.islands[s][k]);
      report->distortion.flipped = written.flipped;
      report->overlaps = written.overlaps;
      layout.report.distortion.flipped += written.flipped;
    }
}

/// What the whole atlas comes to; overlaps only where they were counted in every chart.
void add_totals(Report& report) {
  report.overlaps = 0;
  for (const ChartReport& chart : report.charts) {
    report.area += chart.area;
    report.seam_length += chart.seam_length / 2;  // a seam has two sides
    if (report.overlaps && chart.overlaps)
      *report.overlaps += *chart.overlaps;
    else
      report.overlaps.reset();
  }
  report.seam_ratio = report.seam_length / std::sqrt(report.area);
}

Unwrapped put_back(std::span<const Surface> surfaces, Layout layout, const std::stop_token& stop) {
  Unwrapped unwrapped;
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    unwrapped.surfaces.push_back(
        assemble(surfaces[s], layout.surfaces[s], layout.islands[s], stop));
    const std::vector<double> seams = seam_lengths(surfaces[s], unwrapped.surfaces.back(), stop);
    for (const Chart& chart : layout.surfaces[s].charts) {
      for (const Index t : chart.face_source) report->seam_length += seams[t];
      ++report;
    }
  }
  add_totals(layout.report);
  unwrapped.report = std::move(layout.report);
  return unwrapped;
}

CurvePoint curve_point(double lambda, const Report& report) {
  CurvePoint point{.lambda = lambda, .distortion = report.distortion};
  double area = 0;
  for (const ChartReport& chart : report.charts) {
    area += chart.area;
    point.energy += chart.area * chart.energy.back();
    point.iterations = std::max(point.iterations, chart.iterations);
  }
  point.energy /= area;
  return point;
}

/// Every map's report has the whole curve.
void add_curve(std::vector<Unwrapped>& maps, const std::vector<double>& lambdas) {
  std::vector<CurvePoint> curve;
  for (std::size_t k = 0; k < maps.size(); ++k)
    curve.push_back(curve_point(lambdas[k], maps[k].report));
  for (Unwrapped& map : maps) map.report.curve = curve;
}

}  // namespace

std::vector<Unwrapped> unwrap_curve(std::span<const Surface> surfaces, const UnwrapOptions& options,
                                    const Progress& progress, Executor& executor) {
  validate(options, std::numeric_limits<int>::max());
  if (options.repack_only) return {lambdas_of(options).size(), repack(surfaces, options, progress)};
  JobExecutor job(executor, progress.stop);
  announce(progress, Stage::setup, 0, kChartsBegin);
  check_memory(surfaces, executor.shared_core());
  const Taken taken = take_apart(surfaces, options, progress, job);
  const auto page = page_holds(surfaces, taken.parts, options.constraints, progress.stop);
  std::vector<Layout> layouts = map_charts(taken, page, options, progress, job);

  announce(progress, Stage::pack, layouts.front().report.charts.size(), kPackBegin);
  for (Layout& layout : layouts) {
    lay_out_page(layout, options, progress.stop);
    keep_on_page(layout, options, progress.stop);
  }
  announce(progress, Stage::measure, layouts.front().report.charts.size(), kMeasureBegin);
  std::vector<Unwrapped> maps;
  for (Layout& layout : layouts)
    maps.push_back(put_back(surfaces, std::move(layout), progress.stop));
  if (is_curve(options)) add_curve(maps, lambdas_of(options));
  return maps;
}

Unwrapped unwrap(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  return std::move(unwrap_curve(surfaces, options, progress, executor).front());
}

}  // namespace unwrapd
