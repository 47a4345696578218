#include "core/pipeline/layout.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/charts/outline.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/measure/page_area.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/measure/seam_length.hpp"
#include "core/pipeline/analyse.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/pipeline/density.hpp"
#include "core/pipeline/enlarge_tiny_islands.hpp"
#include "core/pipeline/note_kept_edges.hpp"
#include "core/pipeline/place_islands.hpp"
#include "core/segment/region_charts.hpp"

namespace unwrapd::pipeline {
namespace {

/// The energy that a new map without overlaps keeps low.
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

/// Places every chart on the page; the maps become page UVs.
void pack_free_charts(Layout& layout, std::span<const Surface> surfaces,
                      const UnwrapOptions& options, Executor& executor) {
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k) {
      const double density = density_of(*layout.charts[s][k], surfaces[s], options);
      for (Vec2& uv : layout.islands[s][k]) uv *= density;
    }
  if (!options.packing.texels_per_unit) enlarge_tiny_islands(layout);
  IslandsToPlace islands;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k) {
      const charts::Chart& chart = *layout.charts[s][k];
      UvMap& map = layout.islands[s][k];
      islands.add(charts::outline_of(chart, map), map,
                  group_of(surfaces[s], chart.face_source.front(), options.packing.group));
    }
  place_islands(islands, options, executor, layout.report);
}

/// Notes how many charts the constraints put beyond the page.
void note_charts_beyond(Layout& layout) {
  const auto is_beyond = [](const Vec2& u) { return u.minCoeff() < 0 || u.maxCoeff() > 1; };
  std::ptrdiff_t count = 0;
  for (const std::vector<UvMap>& own : layout.islands)
    count += std::count_if(own.begin(), own.end(), [&](const UvMap& uv) {
      return std::any_of(uv.begin(), uv.end(), is_beyond);
    });
  if (count > 0)
    layout.report.notes.push_back(
        {NoteCode::outside_page, "The constraints put " + std::to_string(count) +
                                     " of the charts partly or wholly outside the page."});
}

/// The figures of the whole atlas. Overlaps are told only if they were counted in every chart.
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

/// The area of the page that triangles cover, at most all of it: some may lie on others.
double covered_page(const Layout& layout) {
  double area = 0;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k)
      area += measure::page_area(layout.charts[s][k]->mesh.faces, layout.islands[s][k]);
  return std::min(area, 1.0);
}

/// Uses the prepared vertex plan unless charts were split.
UnwrappedSurface assemble_surface(const Surface& surface, std::size_t s, const Layout& layout,
                                  const std::stop_token& stop) {
  const Prepared& all = *layout.all;
  const charts::Charts& whole = all.surfaces[s];
  std::vector<const charts::Chart*> charts;
  for (const std::shared_ptr<const charts::Chart>& chart : layout.charts[s])
    charts.push_back(chart.get());
  if (charts == pointers_to(whole.charts)) return assemble(*all.plans[s], layout.islands[s]);
  return assemble(plan_vertices(surface, whole, charts, stop), layout.islands[s]);
}

/// The sums over a chart's triangles as the file has them, with corners that welding has not moved.
measure::DistortionSums sums_in_file(const charts::Chart& chart, const UvMap& uv,
                                     std::span<const Vec3> given, std::span<const Triangle> faces,
                                     Executor& executor) {
  TriMesh mesh;
  UvMap corner_uv;
  for (std::size_t t = 0; t < chart.face_source.size(); ++t) {
    const Triangle& face = faces[static_cast<std::size_t>(chart.face_source[t])];
    const auto first = static_cast<Index>(corner_uv.size());
    mesh.faces.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.positions.push_back(given[static_cast<std::size_t>(face[k])]);
      corner_uv.push_back(uv[static_cast<std::size_t>(chart.mesh.faces[t][k])]);
    }
  }
  return measure::distortion_sums(mesh, corner_uv, executor);
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

}  // namespace

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
  if (all->note) layout.report.notes.push_back(*all->note);
  return {map_count, layout};
}

void add_chart(Layout& layout, std::size_t surface, MappedChart mapped) {
  mapped.report.surface = static_cast<Index>(surface);
  layout.report.charts.push_back(std::move(mapped.report));
  layout.charts[surface].push_back(std::move(mapped.chart));
  layout.islands[surface].push_back(std::move(mapped.uv));
  layout.constrained[surface].push_back(std::move(mapped.constrained));
}

void note_new_maps(Layout& layout, const UnwrapOptions& options) {
  Index moved = 0, cut = 0;
  for (const ChartReport& chart : layout.report.charts)
    if (chart.mending.overlaps > 0) ++(chart.mending.parts == 1 ? moved : cut);
  std::string text;
  if (moved > 0)
    text = "Charts that overlapped themselves and got a new map without overlaps: " +
           std::to_string(moved) + ". The new map stays as close as possible to " +
           kept_energy_of(options.method) + "; energy_rise of the chart's mending tells the cost.";
  if (cut > 0)
    text += (moved > 0 ? " " : "") +
            ("Charts that overlapped themselves and were cut: " + std::to_string(cut)) + ".";
  if (!text.empty()) layout.report.notes.push_back({NoteCode::chart_remapped, text});
  const std::size_t charts = layout.report.charts.size();
  const bool is_told = layout.all->note && layout.all->note->code == NoteCode::charts_exceeded;
  if (!is_told && options.max_charts && std::cmp_greater(charts, *options.max_charts) &&
      has_split_charts(layout))
    layout.report.notes.push_back(
        {NoteCode::charts_exceeded,
         "There are more charts than max_charts, " + std::to_string(charts) +
             ", because no map without flips and overlaps was found for so few."});
}

bool has_split_charts(const Layout& layout) {
  return std::ranges::any_of(layout.report.charts,
                             [](const ChartReport& chart) { return chart.mending.parts > 1; });
}

double border_of(const Prepared& all) {
  double length = 0;
  for (const charts::Charts& surface : all.surfaces)
    for (const charts::Chart& chart : surface.charts)
      length += surface.scale * segment::weighted_boundary(chart);
  return length;
}

double border_of(const Layout& layout) {
  double length = 0;
  for (std::size_t s = 0; s < layout.charts.size(); ++s)
    for (const std::shared_ptr<const charts::Chart>& chart : layout.charts[s])
      length += layout.all->surfaces[s].scale * segment::weighted_boundary(*chart);
  return length;
}

void pack_charts(Layout& layout, std::span<const Surface> surfaces, const UnwrapOptions& options,
                 Executor& executor) {
  const bool are_placed = !options.constraints.empty();
  layout.report.page = options.page_size();
  if (!are_placed) pack_free_charts(layout, surfaces, options, executor);
  for (std::vector<UvMap>& own : layout.islands)
    for (UvMap& map : own) to_uvs(map, layout.report.page);
  if (are_placed) note_charts_beyond(layout);
}

void quantize_maps(Layout& layout, const UnwrapOptions& options, const std::stop_token& stop) {
  auto report = layout.report.charts.begin();
  layout.report.guarantee = options.guarantee;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      guarantee::GuaranteeRules rules{.guarantee = options.guarantee};
      rules.intent = {.rigidity = {}, .constrained = layout.constrained[s][k], .stop = stop};
      const guarantee::Written written =
          guarantee::keep_on_page(*layout.charts[s][k], rules, layout.islands[s][k]);
      report->distortion.flipped = written.flipped;
      report->overlaps = written.overlaps;
    }
}

void measure_maps(Layout& layout, std::span<const Surface> surfaces, std::span<const Surface> given,
                  const UnwrapOptions& options, Executor& executor) {
  double uv_area = 0;
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < layout.islands.size(); ++s) {
    const TriMesh& used = surfaces[s].mesh;
    const bool is_moved = &used != &given[s].mesh && used.positions != given[s].mesh.positions;
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      const charts::Chart& chart = *layout.charts[s][k];
      UvMap uv = layout.islands[s][k];
      to_page_widths(uv, layout.report.page);
      const double density = painted_density(chart, surfaces[s], options);
      for (Vec2& u : uv) u /= density;  // what was asked for is no distortion
      measure::DistortionSums own =
          is_moved ? sums_in_file(chart, uv, given[s].mesh.positions, used.faces, executor)
                   : measure::distortion_sums(
                         measure::flatten(chart.mesh.positions, chart.mesh.faces, executor),
                         chart.mesh.faces, uv, executor);
      own = own.in_units(surfaces[s].scale);
      own.flipped = report->distortion.flipped;  // by exact signs
      report->area = own.area;
      report->distortion = measure::distortion(own);
      layout.sums += own;
      uv_area += density * density * own.uv_area;
    }
  }
  const measure::DistortionSums& sums = layout.sums;
  layout.report.distortion = measure::distortion(sums);
  layout.report.texel_density = std::sqrt(uv_area / sums.area) * layout.report.page.width;
  if (!options.constraints.empty()) layout.report.fill = covered_page(layout);
}

Unwrapped assemble_surfaces(std::span<const Surface> surfaces, Layout layout,
                            const UnwrapOptions& options, const std::stop_token& stop) {
  const Prepared& all = *layout.all;
  Unwrapped unwrapped;
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    unwrapped.surfaces.push_back(assemble_surface(surfaces[s], s, layout, stop));
    const std::vector<double> seams = measure::seam_lengths(
        surfaces[s].mesh, *all.surfaces[s].by_position, unwrapped.surfaces.back(), stop);
    for (const std::shared_ptr<const charts::Chart>& chart : layout.charts[s]) {
      for (const Index t : chart->face_source) report->seam_length += seams[t] * surfaces[s].scale;
      ++report;
    }
  }
  if (auto note = note_kept_edges(surfaces, unwrapped.surfaces, options.keep_edges, stop))
    layout.report.notes.push_back(std::move(*note));
  add_totals(layout.report);
  unwrapped.report = std::move(layout.report);
  return unwrapped;
}

void report_curve(std::vector<Unwrapped>& maps, const std::vector<double>& lambdas) {
  std::vector<CurvePoint> curve;
  for (std::size_t k = 0; k < maps.size(); ++k)
    curve.push_back(curve_point(lambdas[k], maps[k].report));
  for (Unwrapped& map : maps) map.report.curve = curve;
}

}  // namespace unwrapd::pipeline
