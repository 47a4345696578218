#include "core/pipeline/map_surfaces.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "core/charts/constraints.hpp"
#include "core/pipeline/analyse.hpp"
#include "core/pipeline/parameterize_chart.hpp"
#include "core/segment/excess_steps.hpp"
#include "core/segment/region_charts.hpp"

namespace unwrapd::pipeline {
namespace {

/// A page for each map: what came in is in its report, charts are not in it yet.
std::vector<Layout> empty_layouts(const std::shared_ptr<const Prepared>& all,
                                  std::size_t map_count) {
  const std::vector<charts::Charts>& parts = all->surfaces;
  Layout layout;
  layout.all = all;
  layout.charts.resize(parts.size());
  layout.islands.resize(parts.size());
  layout.constrained.resize(parts.size());
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
  layout.constrained[surface].push_back(std::move(mapped.constrained));
}

ChartProgress progress_of(const PreparedCharts& taken, const Progress& progress,
                          Executor& executor) {
  std::size_t chart_count = 0, face_count = 0;
  for (const charts::Charts& part : taken.all->surfaces) {
    chart_count += part.charts.size();
    for (const charts::Chart& chart : part.charts) face_count += chart.mesh.faces.size();
  }
  require_area(taken.all->surfaces);
  return {progress, static_cast<Index>(chart_count), face_count, taken.solve_begin, executor};
}

/// What a map without overlaps keeps of the method's own.
std::string kept_energy_of(Method method) {
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
        "Charts that overlapped themselves and got a new map without overlaps: " +
        std::to_string(count) + ". The new map stays as close as possible to " +
        kept_energy_of(options.method) + "; energy_rise of the chart's mending tells the cost.");
}

std::vector<Layout> parameterize_charts(const PreparedCharts& taken,
                                        std::span<const Surface> surfaces,
                                        const UnwrapOptions& options, const Progress& progress,
                                        Executor& executor) {
  const Prepared& all = *taken.all;
  const auto page =
      charts::page_constraints(surfaces, all.surfaces, options.constraints, progress.stop);
  ChartProgress watch = progress_of(taken, progress, executor);
  std::vector<Layout> layouts = empty_layouts(taken.all, lambdas_of(options).size());
  if (!all.note.empty())
    for (Layout& layout : layouts) layout.report.notes.push_back(all.note);
  for (std::size_t s = 0; s < all.surfaces.size(); ++s)
    for (std::size_t c = 0; c < all.surfaces[s].charts.size(); ++c) {
      const std::shared_ptr<const charts::Chart> chart(taken.all, &all.surfaces[s].charts[c]);
      auto maps =
          parameterize_chart({chart, all.disks[s][c], page[s][c]}, options, watch, executor);
      for (std::size_t k = 0; k < maps.size(); ++k)
        for (MappedChart& mapped : maps[k]) add_chart(layouts[k], s, std::move(mapped));
    }
  for (Layout& layout : layouts) note_new_maps(layout, options);
  return layouts;
}

bool has_split_charts(const Layout& layout) {
  return std::ranges::any_of(layout.report.charts,
                             [](const ChartReport& chart) { return chart.mending.parts > 1; });
}

/// The borders of all charts before they are mapped.
double border_of(const Prepared& all) {
  double length = 0;
  for (const charts::Charts& surface : all.surfaces)
    for (const charts::Chart& chart : surface.charts) length += segment::boundary_length(chart);
  return length;
}

/// The borders of all charts, those of splits with them.
double border_of(const Layout& layout) {
  double length = 0;
  for (const auto& charts : layout.charts)
    for (const std::shared_ptr<const charts::Chart>& chart : charts)
      length += segment::boundary_length(*chart);
  return length;
}

/// Whether another bound of distortion makes other charts.
bool has_bound(const UnwrapOptions& options) {
  return options.max_distortion && options.max_charts != 1 && options.constraints.empty() &&
         options.boundary == BoundaryShape::free;
}

/// The layouts of tighter bounds where their borders are shorter, which they can be where charts
/// were split. The search ends at a bound whose charts have longer borders before any is split.
void take_shorter_seams(std::span<const Surface> surfaces, UnwrapOptions options,
                        const std::stop_token& stop, Executor& executor,
                        std::vector<Layout>& layouts) {
  const Progress quiet{.on_stage = {}, .on_iteration = {}, .stop = stop};
  double last = border_of(*layouts.front().all);
  const auto is_shorter = [&](const Layout& own) { return last < border_of(own); };
  bool is_split = std::ranges::any_of(layouts, has_split_charts);
  while (is_split && (options.max_distortion = segment::tighter_bound(*options.max_distortion))) {
    const PreparedCharts taken = prepare_charts(surfaces, options, quiet, executor);
    const double border = border_of(*taken.all);
    if (std::exchange(last, border) == border) continue;  // the same charts
    if (!taken.all->note.empty() || std::ranges::none_of(layouts, is_shorter)) return;
    std::vector<Layout> others = parameterize_charts(taken, surfaces, options, quiet, executor);
    is_split = std::ranges::any_of(others, has_split_charts);
    for (std::size_t k = 0; k < layouts.size(); ++k)
      if (border_of(others[k]) < border_of(layouts[k])) layouts[k] = std::move(others[k]);
  }
}

}  // namespace

std::vector<Layout> map_surfaces(std::span<const Surface> surfaces, const UnwrapOptions& options,
                                 const Progress& progress, Executor& executor) {
  const PreparedCharts taken = prepare_charts(surfaces, options, progress, executor);
  std::vector<Layout> layouts = parameterize_charts(taken, surfaces, options, progress, executor);
  if (has_bound(options)) take_shorter_seams(surfaces, options, progress.stop, executor, layouts);
  return layouts;
}

}  // namespace unwrapd::pipeline
