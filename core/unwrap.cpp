// Unwrapping, step by step. unwrap_curve() is the list for all surfaces: repair, prepare charts,
// map them, straighten, pack, quantize, measure, order, note faults, assemble, report.
// pipeline::map_chart() is the list for one chart.
#include "core/unwrap.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/shared_work.hpp"
#include "core/charts/constraints.hpp"
#include "core/charts/repair_surfaces.hpp"
#include "core/pipeline/chart_progress.hpp"
#include "core/pipeline/layout.hpp"
#include "core/pipeline/map_all.hpp"
#include "core/pipeline/note_faults.hpp"
#include "core/pipeline/order_layouts.hpp"
#include "core/pipeline/prepare_charts.hpp"
#include "core/pipeline/repack.hpp"
#include "core/pipeline/straighten_charts.hpp"
#include "core/segment/segment.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd {
namespace {

using pipeline::Layout;
using pipeline::MappedChart;
using pipeline::PreparedCharts;

/// Shares of the job that are done when a step of core begins. Reading comes before these steps,
/// writing after.
constexpr double kPackBegin = pipeline::kSolveEnd, kMeasureBegin = 0.93;

void announce(const Progress& progress, Stage stage, std::size_t charts, double fraction) {
  if (progress.on_stage) progress.on_stage({stage, 0, static_cast<Index>(charts), fraction});
}

/// The maps of all charts: a layout for each lambda.
std::vector<Layout> map_charts(const PreparedCharts& prepared, std::span<const Surface> surfaces,
                               const UnwrapOptions& options, const Progress& progress,
                               Executor& executor) {
  const pipeline::Prepared& all = *prepared.all;
  auto page = charts::page_constraints(surfaces, all.surfaces, options.constraints, progress.stop);
  for (std::vector<solve::VertexConstraints>& own : page)
    for (solve::VertexConstraints& chart : own)
      chart = solve::stretched_v(std::move(chart), options.page_size().aspect());
  pipeline::ChartProgress watch(progress, all.surfaces, prepared.solve_begin, executor);
  std::vector<Layout> layouts =
      pipeline::empty_layouts(prepared.all, pipeline::lambdas_of(options).size());
  std::vector<pipeline::ChartJob> jobs;
  std::vector<std::size_t> surface_of;
  for (std::size_t s = 0; s < all.surfaces.size(); ++s)
    for (std::size_t c = 0; c < all.surfaces[s].charts.size(); ++c) {
      const std::shared_ptr<const charts::Chart> chart(prepared.all, &all.surfaces[s].charts[c]);
      jobs.push_back({chart, all.disks[s][c], page[s][c]});
      surface_of.push_back(s);
    }
  auto maps = pipeline::map_all(jobs, options, watch, executor);
  for (std::size_t c = 0; c < maps.size(); ++c)
    for (std::size_t k = 0; k < maps[c].size(); ++k)
      for (MappedChart& mapped : maps[c][k])
        add_chart(layouts[k], surface_of[c], std::move(mapped));
  for (Layout& layout : layouts) note_new_maps(layout, options);
  return layouts;
}

/// Whether a tighter bound of distortion can lead to other charts.
bool has_bound(const UnwrapOptions& options) {
  return options.max_distortion && options.max_charts != 1 && !keeps_whole(options);
}

/// Whether some borders are shorter and none longer. All lambdas of a list then have the same
/// charts, as their order needs.
bool has_shorter_borders(const std::vector<Layout>& layouts, const std::vector<Layout>& others) {
  bool is_shorter = false, is_longer = false;
  for (std::size_t k = 0; k < layouts.size(); ++k) {
    is_shorter |= border_of(layouts[k]) < border_of(others[k]);
    is_longer |= border_of(layouts[k]) > border_of(others[k]);
  }
  return is_shorter && !is_longer;
}

/// Splits make borders longer. Where charts were split, tighter bounds of distortion are tried, and
/// the layouts with shorter borders are taken (ADR 0039). The search ends at a bound whose charts
/// have longer borders before any of them is split.
void try_tighter_bounds(std::span<const Surface> surfaces, UnwrapOptions options,
                        const std::stop_token& stop, Executor& executor,
                        std::vector<Layout>& layouts) {
  const Progress quiet{.on_stage = {}, .on_iteration = {}, .stop = stop};
  double last = border_of(*layouts.front().all);
  const auto is_shorter = [&](const Layout& own) { return last < border_of(own); };
  bool is_split = std::ranges::any_of(layouts, pipeline::has_split_charts);
  while (is_split && (options.max_distortion =
                          segment::tighter_bound(*options.max_distortion, options.effort))) {
    const PreparedCharts prepared = pipeline::prepare_charts(surfaces, options, quiet, executor);
    const double border = border_of(*prepared.all);
    if (std::exchange(last, border) == border) continue;  // the same charts
    if (prepared.all->note || std::ranges::none_of(layouts, is_shorter)) return;
    std::vector<Layout> others = map_charts(prepared, surfaces, options, quiet, executor);
    is_split = std::ranges::any_of(others, pipeline::has_split_charts);
    if (has_shorter_borders(others, layouts)) layouts = std::move(others);
  }
}

/// The faces as they came in, and the repairs before all others.
void restore_input(const charts::RepairedSurfaces& repaired, Unwrapped& map) {
  charts::exchange_winding(repaired, map.surfaces);
  std::vector<Repair>& repairs = map.report.repairs;
  repairs.insert(repairs.begin(), repaired.repairs.begin(), repaired.repairs.end());
}

}  // namespace

std::vector<Unwrapped> unwrap_curve(std::span<const Surface> given, const UnwrapOptions& options,
                                    const Progress& progress, Executor& executor) {
  validate(options, std::numeric_limits<int>::max());
  JobExecutor job(executor, progress.stop);
  const std::vector<double> lambdas = pipeline::lambdas_of(options);
  if (options.keeps_uvs()) return {lambdas.size(), pipeline::repack(given, options, progress, job)};

  announce(progress, Stage::setup, 0, pipeline::kChartsBegin);
  const charts::RepairedSurfaces repaired =
      charts::repair_surfaces(given, options.welding, progress.stop);
  const std::span<const Surface> surfaces = repaired.surfaces;
  const PreparedCharts prepared = pipeline::prepare_charts(surfaces, options, progress, job);
  std::vector<Layout> layouts = map_charts(prepared, surfaces, options, progress, job);
  if (has_bound(options)) try_tighter_bounds(surfaces, options, progress.stop, job, layouts);

  if (SharedWork* helpers = job.shared_work()) helpers->finish();
  announce(progress, Stage::pack, layouts.front().report.charts.size(), kPackBegin);
  for (Layout& layout : layouts) {
    straighten_charts(layout, options, job);
    pack_charts(layout, surfaces, options, job);
    quantize_maps(layout, options, progress.stop);
  }
  announce(progress, Stage::measure, layouts.front().report.charts.size(), kMeasureBegin);
  for (Layout& layout : layouts) measure_maps(layout, surfaces, given, options, job);
  pipeline::order_layouts(layouts, options, job);
  for (Layout& layout : layouts) note_faults(layout, surfaces, options);
  std::vector<Unwrapped> maps;
  for (Layout& layout : layouts)
    maps.push_back(assemble_surfaces(surfaces, std::move(layout), options, progress.stop));
  for (Unwrapped& map : maps) restore_input(repaired, map);
  if (pipeline::is_curve(options)) pipeline::report_curve(maps, lambdas);
  return maps;
}

Unwrapped unwrap(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  return std::move(unwrap_curve(surfaces, options, progress, executor).front());
}

}  // namespace unwrapd
