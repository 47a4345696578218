// The whole of core at a glance: surfaces are taken apart into charts, each chart is mapped, all
// are packed on one page, and the page's UVs are measured and put back on the surfaces.
#include "core/unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/charts/constraints.hpp"
#include "core/charts/outline.hpp"
#include "core/guarantee/promise.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/measure/seam_length.hpp"
#include "core/pack/pack.hpp"
#include "core/pipeline/analyse.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/pipeline/map_chart.hpp"
#include "core/pipeline/place_islands.hpp"
#include "core/pipeline/repack.hpp"
#include "core/pipeline/take_apart.hpp"

namespace unwrapd {
namespace {

/// Shares of the job that are behind us when a step of core begins; reading comes before, writing
/// after.
constexpr double kPackBegin = kSolveEnd, kMeasureBegin = 0.93;

/// All charts under one map: what goes on one page.
struct Layout {
  std::vector<std::vector<std::shared_ptr<const Chart>>> charts;  ///< of each surface, as mapped
  std::vector<std::vector<UvMap>> islands;           ///< islands[s][k]: the map of charts[s][k]
  std::vector<std::vector<std::vector<char>>> held;  ///< held[s][k]: see MappedChart
  DistortionSums sums;  ///< of all charts, from space to the page as it is written
  Report report;
};

void announce(const Progress& progress, Stage stage, std::size_t charts, double fraction) {
  if (progress.on_stage) progress.on_stage({stage, 0, static_cast<Index>(charts), fraction});
}

/// A page for each map: what came in is in its report, charts are not in it yet.
std::vector<Layout> empty_layouts(const std::vector<Charts>& parts, std::size_t map_count) {
  Layout layout;
  layout.charts.resize(parts.size());
  layout.islands.resize(parts.size());
  layout.held.resize(parts.size());
  const InputAnalysis analysis = analysis_of(parts);
  layout.report.input = analysis.input;
  layout.report.repairs = analysis.repairs;
  return {map_count, layout};
}

void add_chart(Layout& layout, std::size_t surface, MappedChart mapped) {
  mapped.report.surface = static_cast<Index>(surface);
  layout.report.charts.push_back(std::move(mapped.report));
  layout.charts[surface].push_back(std::move(mapped.chart));
  layout.islands[surface].push_back(std::move(mapped.uv));
  layout.held[surface].push_back(std::move(mapped.held));
}

ChartWatch chart_watch(const TakenApart& taken, const Progress& progress, Executor& executor) {
  std::size_t chart_count = 0, face_count = 0;
  for (const Charts& part : taken.all->surfaces) {
    chart_count += part.charts.size();
    for (const Chart& chart : part.charts) face_count += chart.mesh.faces.size();
  }
  require_area(taken.all->surfaces);
  return {progress, static_cast<Index>(chart_count), face_count, taken.solve_begin, executor};
}

/// What a map without overlaps keeps of the method's own.
std::string kept_of(Method method) {
  switch (method) {
    case Method::arap:
      return "ARAP's energy";
    case Method::hybrid:
      return "the method's own energy (below a lambda of 0.01: to the angles of its own map)";
    case Method::slim:
      return "the symmetric Dirichlet energy";
    default:
      return "the angles of the method's own map";
  }
}

/// Says which maps are not those of the method.
void note_new_maps(Layout& layout, const UnwrapOptions& options) {
  const auto is_new = [](const ChartReport& chart) {
    return chart.mending.overlaps > 0 && chart.mending.parts == 1;
  };
  const auto& charts = layout.report.charts;
  if (const auto count = std::count_if(charts.begin(), charts.end(), is_new); count > 0)
    layout.report.notes.push_back(
        "Charts that overlapped themselves and have a new map without overlaps: " +
        std::to_string(count) + ". The new map keeps as near as it can to " +
        kept_of(options.method) + "; energy_rise of the chart's mending is the cost.");
}

/// page: the position constraints of every chart of every surface.
std::vector<Layout> map_charts(const TakenApart& taken, const std::vector<std::vector<Holds>>& page,
                               const UnwrapOptions& options, const Progress& progress,
                               Executor& executor) {
  const Prepared& all = *taken.all;
  ChartWatch watch = chart_watch(taken, progress, executor);
  std::vector<Layout> layouts = empty_layouts(all.surfaces, lambdas_of(options).size());
  if (!all.note.empty())
    for (Layout& layout : layouts) layout.report.notes.push_back(all.note);
  for (std::size_t s = 0; s < all.surfaces.size(); ++s)
    for (std::size_t c = 0; c < all.surfaces[s].charts.size(); ++c) {
      const std::shared_ptr<const Chart> chart(taken.all, &all.surfaces[s].charts[c]);
      auto maps = map_chart({chart, all.disks[s][c], page[s][c]}, options, watch, executor);
      for (std::size_t k = 0; k < maps.size(); ++k)
        for (MappedChart& mapped : maps[k]) add_chart(layouts[k], s, std::move(mapped));
    }
  for (Layout& layout : layouts) note_new_maps(layout, options);
  return layouts;
}

/// Places every chart on the page; the maps become page UVs.
void place(Layout& layout, const UnwrapOptions& options, Executor& executor) {
  std::vector<Outline> outlines;
  std::vector<UvMap*> maps;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k) {
      outlines.push_back(outline_of(*layout.charts[s][k], layout.islands[s][k]));
      maps.push_back(&layout.islands[s][k]);
    }
  place_islands(outlines, options, executor, maps, layout.report);
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
void lay_out_page(Layout& layout, const UnwrapOptions& options, Executor& executor) {
  if (options.constraints.empty())
    place(layout, options, executor);
  else
    note_charts_beyond(layout);
}

/// The promise kept in what is written.
void keep_on_page(Layout& layout, const UnwrapOptions& options, const std::stop_token& stop) {
  auto report = layout.report.charts.begin();
  layout.report.guarantee = options.guarantee;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      Promise promise{.guarantee = options.guarantee};
      promise.intent = {.rigidity = {}, .held = layout.held[s][k], .stop = stop};
      const Written written = keep_on_page(*layout.charts[s][k], promise, layout.islands[s][k]);
      report->distortion.flipped = written.flipped;
      report->overlaps = written.overlaps;
    }
}

/// Distortion and density of the triangles as they are written: rounding counts, too.
void measure(Layout& layout, const UnwrapOptions& options, Executor& executor) {
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      const TriMesh& mesh = layout.charts[s][k]->mesh;
      DistortionSums own = distortion_sums(flatten(mesh.positions, mesh.faces, executor),
                                           mesh.faces, layout.islands[s][k], executor);
      own.flipped = report->distortion.flipped;  // by exact signs
      report->area = own.area;
      report->distortion = distortion(own);
      layout.sums += own;
    }
  const DistortionSums& sums = layout.sums;
  layout.report.distortion = distortion(sums);
  layout.report.texel_density = std::sqrt(sums.uv_area / sums.area) * options.resolution;
  if (!options.constraints.empty()) layout.report.fill = sums.uv_area;
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

/// The plan that is there already, unless charts came apart.
UnwrappedSurface assembled(const Surface& surface, const Prepared& all, std::size_t s,
                           const Layout& layout, const std::stop_token& stop) {
  const Charts& whole = all.surfaces[s];
  std::vector<const Chart*> charts;
  for (const std::shared_ptr<const Chart>& chart : layout.charts[s]) charts.push_back(chart.get());
  if (charts == pointers_to(whole.charts)) return assemble(*all.plans[s], layout.islands[s]);
  return assemble(plan_vertices(surface, whole, charts, stop), layout.islands[s]);
}

Unwrapped put_back(std::span<const Surface> surfaces, const Prepared& all, Layout layout,
                   const std::stop_token& stop) {
  Unwrapped unwrapped;
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    unwrapped.surfaces.push_back(assembled(surfaces[s], all, s, layout, stop));
    const std::vector<double> seams = seam_lengths(surfaces[s].mesh, *all.surfaces[s].by_position,
                                                   unwrapped.surfaces.back(), stop);
    for (const std::shared_ptr<const Chart>& chart : layout.charts[s]) {
      for (const Index t : chart->face_source) report->seam_length += seams[t];
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
  JobExecutor job(executor, progress.stop);
  if (options.repack_only)
    return {lambdas_of(options).size(), repack(surfaces, options, progress, job)};
  announce(progress, Stage::setup, 0, kChartsBegin);
  const TakenApart taken = take_apart(surfaces, options, progress, job);
  const auto page = page_holds(surfaces, taken.all->surfaces, options.constraints, progress.stop);
  std::vector<Layout> layouts = map_charts(taken, page, options, progress, job);

  announce(progress, Stage::pack, layouts.front().report.charts.size(), kPackBegin);
  for (Layout& layout : layouts) {
    lay_out_page(layout, options, job);
    keep_on_page(layout, options, progress.stop);
  }
  announce(progress, Stage::measure, layouts.front().report.charts.size(), kMeasureBegin);
  for (Layout& layout : layouts) measure(layout, options, job);
  std::vector<Unwrapped> maps;
  for (Layout& layout : layouts)
    maps.push_back(put_back(surfaces, *taken.all, std::move(layout), progress.stop));
  if (is_curve(options)) add_curve(maps, lambdas_of(options));
  return maps;
}

Unwrapped unwrap(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  return std::move(unwrap_curve(surfaces, options, progress, executor).front());
}

}  // namespace unwrapd
