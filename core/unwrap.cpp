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
#include "core/guarantee/keep_guarantee.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/measure/seam_length.hpp"
#include "core/pack/pack.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/pipeline/chart_progress.hpp"
#include "core/pipeline/map_surfaces.hpp"
#include "core/pipeline/parameterize_chart.hpp"
#include "core/pipeline/place_islands.hpp"
#include "core/pipeline/repack.hpp"

namespace unwrapd {
namespace {

/// Shares of the job that are behind us when a step of core begins; reading comes before, writing
/// after.
constexpr double kPackBegin = pipeline::kSolveEnd, kMeasureBegin = 0.93;

void announce(const Progress& progress, Stage stage, std::size_t charts, double fraction) {
  if (progress.on_stage) progress.on_stage({stage, 0, static_cast<Index>(charts), fraction});
}

/// Places every chart on the page; the maps become page UVs.
void place(pipeline::Layout& layout, const UnwrapOptions& options, Executor& executor) {
  std::vector<charts::Outline> outlines;
  std::vector<UvMap*> maps;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k) {
      outlines.push_back(charts::outline_of(*layout.charts[s][k], layout.islands[s][k]));
      maps.push_back(&layout.islands[s][k]);
    }
  pipeline::place_islands(outlines, options, executor, maps, layout.report);
}

/// Says where constraints reach beyond the page.
void note_charts_beyond(pipeline::Layout& layout) {
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
void lay_out_page(pipeline::Layout& layout, const UnwrapOptions& options, Executor& executor) {
  if (options.constraints.empty())
    place(layout, options, executor);
  else
    note_charts_beyond(layout);
}

/// The promise kept in what is written.
void keep_on_page(pipeline::Layout& layout, const UnwrapOptions& options,
                  const std::stop_token& stop) {
  auto report = layout.report.charts.begin();
  layout.report.guarantee = options.guarantee;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      guarantee::GuaranteeRules promise{.guarantee = options.guarantee};
      promise.intent = {.rigidity = {}, .constrained = layout.constrained[s][k], .stop = stop};
      const guarantee::Written written =
          guarantee::keep_on_page(*layout.charts[s][k], promise, layout.islands[s][k]);
      report->distortion.flipped = written.flipped;
      report->overlaps = written.overlaps;
    }
}

/// Distortion and density of the triangles as they are written: rounding counts, too.
void measure_layout(pipeline::Layout& layout, const UnwrapOptions& options, Executor& executor) {
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      const TriMesh& mesh = layout.charts[s][k]->mesh;
      measure::DistortionSums own =
          measure::distortion_sums(measure::flatten(mesh.positions, mesh.faces, executor),
                                   mesh.faces, layout.islands[s][k], executor);
      own.flipped = report->distortion.flipped;  // by exact signs
      report->area = own.area;
      report->distortion = measure::distortion(own);
      layout.sums += own;
    }
  const measure::DistortionSums& sums = layout.sums;
  layout.report.distortion = measure::distortion(sums);
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
UnwrappedSurface assembled(const Surface& surface, std::size_t s, const pipeline::Layout& layout,
                           const std::stop_token& stop) {
  const pipeline::Prepared& all = *layout.all;
  const charts::Charts& whole = all.surfaces[s];
  std::vector<const charts::Chart*> charts;
  for (const std::shared_ptr<const charts::Chart>& chart : layout.charts[s])
    charts.push_back(chart.get());
  if (charts == pipeline::pointers_to(whole.charts))
    return pipeline::assemble(*all.plans[s], layout.islands[s]);
  return pipeline::assemble(pipeline::plan_vertices(surface, whole, charts, stop),
                            layout.islands[s]);
}

Unwrapped put_back(std::span<const Surface> surfaces, pipeline::Layout layout,
                   const std::stop_token& stop) {
  const pipeline::Prepared& all = *layout.all;
  Unwrapped unwrapped;
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    unwrapped.surfaces.push_back(assembled(surfaces[s], s, layout, stop));
    const std::vector<double> seams = measure::seam_lengths(
        surfaces[s].mesh, *all.surfaces[s].by_position, unwrapped.surfaces.back(), stop);
    for (const std::shared_ptr<const charts::Chart>& chart : layout.charts[s]) {
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
    return {pipeline::lambdas_of(options).size(),
            pipeline::repack(surfaces, options, progress, job)};
  announce(progress, Stage::setup, 0, pipeline::kChartsBegin);
  std::vector<pipeline::Layout> layouts = pipeline::map_surfaces(surfaces, options, progress, job);

  announce(progress, Stage::pack, layouts.front().report.charts.size(), kPackBegin);
  for (pipeline::Layout& layout : layouts) {
    lay_out_page(layout, options, job);
    keep_on_page(layout, options, progress.stop);
  }
  announce(progress, Stage::measure, layouts.front().report.charts.size(), kMeasureBegin);
  for (pipeline::Layout& layout : layouts) measure_layout(layout, options, job);
  std::vector<Unwrapped> maps;
  for (pipeline::Layout& layout : layouts)
    maps.push_back(put_back(surfaces, std::move(layout), progress.stop));
  if (pipeline::is_curve(options)) add_curve(maps, pipeline::lambdas_of(options));
  return maps;
}

Unwrapped unwrap(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  return std::move(unwrap_curve(surfaces, options, progress, executor).front());
}

}  // namespace unwrapd
