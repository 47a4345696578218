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
#include "core/charts/outline.hpp"
#include "core/guarantee/promise.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/measure/seam_length.hpp"
#include "core/pack/pack.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/pipeline/chart_watch.hpp"
#include "core/pipeline/map_chart.hpp"
#include "core/pipeline/map_surfaces.hpp"
#include "core/pipeline/place_islands.hpp"
#include "core/pipeline/repack.hpp"

namespace unwrapd {
namespace {

/// Shares of the job that are behind us when a step of core begins; reading comes before, writing
/// after.
constexpr double kPackBegin = kSolveEnd, kMeasureBegin = 0.93;

void announce(const Progress& progress, Stage stage, std::size_t charts, double fraction) {
  if (progress.on_stage) progress.on_stage({stage, 0, static_cast<Index>(charts), fraction});
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
UnwrappedSurface assembled(const Surface& surface, std::size_t s, const Layout& layout,
                           const std::stop_token& stop) {
  const Prepared& all = *layout.all;
  const Charts& whole = all.surfaces[s];
  std::vector<const Chart*> charts;
  for (const std::shared_ptr<const Chart>& chart : layout.charts[s]) charts.push_back(chart.get());
  if (charts == pointers_to(whole.charts)) return assemble(*all.plans[s], layout.islands[s]);
  return assemble(plan_vertices(surface, whole, charts, stop), layout.islands[s]);
}

Unwrapped put_back(std::span<const Surface> surfaces, Layout layout, const std::stop_token& stop) {
  const Prepared& all = *layout.all;
  Unwrapped unwrapped;
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    unwrapped.surfaces.push_back(assembled(surfaces[s], s, layout, stop));
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
  std::vector<Layout> layouts = map_surfaces(surfaces, options, progress, job);

  announce(progress, Stage::pack, layouts.front().report.charts.size(), kPackBegin);
  for (Layout& layout : layouts) {
    lay_out_page(layout, options, job);
    keep_on_page(layout, options, progress.stop);
  }
  announce(progress, Stage::measure, layouts.front().report.charts.size(), kMeasureBegin);
  for (Layout& layout : layouts) measure(layout, options, job);
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
