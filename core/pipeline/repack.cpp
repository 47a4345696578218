// Nothing is solved: islands are found, placed, rounded to what is written, and measured there; or
// they stay where they are, and are measured.
#include "core/pipeline/repack.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/uv_islands.hpp"
#include "core/guarantee/quantize_uvs.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/overlaps.hpp"
#include "core/measure/page_area.hpp"
#include "core/measure/seam_length.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/pack_around.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/pipeline/locked_islands.hpp"
#include "core/pipeline/place_islands.hpp"

namespace unwrapd::pipeline {
namespace {

/// name: of the option that wants them.
std::vector<charts::UvIslands> find_islands(std::span<const Surface> surfaces,
                                            const std::string& name, const std::stop_token& stop) {
  std::vector<charts::UvIslands> all;
  bool are_any = false;
  for (const Surface& surface : surfaces) {
    throw_if_cancelled(stop);
    all.push_back(charts::uv_islands(surface));
    are_any |= !all.back().maps.empty();
  }
  if (!are_any)
    throw Error(ErrorCode::no_texture_coordinates,
                "The asset lacks the texture coordinates that " + name + " takes; leave out " +
                    name + ", or select another set with texcoord.",
                "/" + name);
  return all;
}

measure::DistortionSums sums_of(const charts::Chart& chart, const UvMap& uv) {
  SerialExecutor serial;
  return measure::distortion_sums(chart.mesh, uv, serial);
}

/// Each island at the size at which its UV area is its area in the scene.
void even_out(charts::UvIslands& islands, double scene_scale) {
  for (std::size_t k = 0; k < islands.maps.size(); ++k) {
    const measure::DistortionSums sums = sums_of(islands.charts.charts[k], islands.maps[k]);
    if (!(sums.area > 0 && sums.uv_area > 0)) continue;
    const double scale = scene_scale * std::sqrt(sums.area / sums.uv_area);
    for (Vec2& uv : islands.maps[k]) uv *= scale;
    for (auto& [a, b] : islands.outlines[k]) a *= scale, b *= scale;
  }
}

void widen_outlines(charts::UvIslands& islands, const PageSize& page) {
  for (charts::Outline& outline : islands.outlines)
    for (auto& side : outline)
      for (Vec2& end : side) end.y() *= page.aspect();
}

void widen_to_page(charts::UvIslands& islands, const PageSize& page) {
  for (UvMap& map : islands.maps) to_page_widths(map, page);
  widen_outlines(islands, page);
}

void place(std::span<const Surface> surfaces, std::vector<charts::UvIslands>& all,
           const UnwrapOptions& options, Executor& executor, Report& report) {
  IslandsToPlace islands;
  for (std::size_t s = 0; s < all.size(); ++s) {
    charts::UvIslands& own = all[s];
    widen_to_page(own, options.page_size());
    if (options.packing.texels_per_unit) even_out(own, surfaces[s].scale);
    for (std::size_t k = 0; k < own.maps.size(); ++k) {
      const Index face = own.charts.charts[k].face_source.front();
      islands.add(own.outlines[k], own.maps[k], group_of(surfaces[s], face, options.packing.group));
    }
  }
  place_islands(islands, options, executor, report);
  report.fill = std::min(report.fill, 1.0);  // faces on top of each other count each
  for (UvMap* map : islands.maps) {
    to_uvs(*map, report.page);
    guarantee::round_to_step(*map);
  }
}

/// The pairs of all faces on the page, also of different islands.
Index count_overlaps(const std::vector<charts::UvIslands>& all, const std::stop_token& stop) {
  std::vector<Triangle> faces;
  UvMap uv;
  for (const charts::UvIslands& own : all)
    for (std::size_t k = 0; k < own.maps.size(); ++k) {
      const auto first = static_cast<Index>(uv.size());
      for (const Triangle& face : own.charts.charts[k].mesh.faces)
        faces.push_back({face[0] + first, face[1] + first, face[2] + first});
      uv.insert(uv.end(), own.maps[k].begin(), own.maps[k].end());
    }
  return static_cast<Index>(
      measure::overlapping_pairs(faces, uv, measure::kMostPairs, stop).size());
}

void note_overlaps(Report& report) {
  if (report.overlaps == 0) return;
  report.notes.push_back(
      {NoteCode::overlaps,
       std::to_string(*report.overlaps) +
           " pairs of triangles overlap on the page, so that they share texels: locked islands lie "
           "on each other, or islands overlapped themselves before. Move or unlock islands, or "
           "unwrap the asset."});
}

/// Places the islands that are not locked beside those that are, which lie where the option says.
void place_around(std::span<const Surface> surfaces, std::vector<charts::UvIslands>& all,
                  const UnwrapOptions& options, Executor& executor, Report& report) {
  report.page = options.page_size();
  for (charts::UvIslands& own : all) widen_outlines(own, report.page);
  const std::vector<std::vector<char>> is_locked =
      lay_locked_islands(surfaces, options, executor.stop(), all);
  std::vector<charts::Outline> locked, free;
  std::vector<UvMap*> maps;
  double covered = 0;
  for (std::size_t s = 0; s < all.size(); ++s)
    for (std::size_t k = 0; k < all[s].maps.size(); ++k) {
      const charts::Outline& outline = all[s].outlines[k];
      covered += std::abs(charts::area_of(outline));
      (is_locked[s][k] != 0 ? locked : free).push_back(outline);
      if (is_locked[s][k] == 0) maps.push_back(&all[s].maps[k]);
    }
  const pack::PackResult packed = pack::pack_around(
      free, locked,
      {report.page.width, options.padding, options.packing, options.effort, report.page.height},
      executor);
  report.pages = packed.pages;
  report.fill = std::min(covered / packed.pages / report.page.aspect(), 1.0);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    to_page_widths(*maps[k], report.page);
    for (Vec2& uv : *maps[k]) uv = packed.placements[k](uv);
    to_uvs(*maps[k], report.page);
    guarantee::round_to_step(*maps[k]);
  }
  report.overlaps = count_overlaps(all, executor.stop());
  note_overlaps(report);
}

void leave_in_place(const std::vector<charts::UvIslands>& all, const UnwrapOptions& options,
                    const std::stop_token& stop, Report& report) {
  report.page = options.page_size();
  report.overlaps = count_overlaps(all, stop);
  report.fill = 0;
  for (const charts::UvIslands& own : all)
    for (std::size_t k = 0; k < own.maps.size(); ++k)
      report.fill += measure::page_area(own.charts.charts[k].mesh.faces, own.maps[k]);
  report.fill = std::min(report.fill, 1.0);  // faces on top of each other count each
}

ChartReport report_of(const charts::Chart& chart, const measure::DistortionSums& sums,
                      std::size_t surface) {
  ChartReport report{.surface = static_cast<Index>(surface),
                     .faces = chart.mesh.face_count(),
                     .vertices = chart.mesh.vertex_count()};
  report.area = sums.area;
  report.distortion = measure::distortion(sums);
  report.stop_reason = StopReason::direct;
  return report;
}

void note_faces_without(const std::vector<charts::UvIslands>& all, Report& report) {
  std::size_t count = 0;
  for (const charts::UvIslands& islands : all) {
    count += islands.charts.set_aside.size();
    if (islands.maps.empty()) count += static_cast<std::size_t>(islands.charts.input.faces);
  }
  if (count > 0)
    report.notes.push_back(
        {NoteCode::faces_without_uvs,
         std::to_string(count) +
             " faces of the input have no texture coordinates, and so no area on the "
             "page: they lie on an edge or a point of a neighbour, or at (0, 0)."});
}

bool has_area(const charts::Chart& chart, const UvMap& uv) {
  return std::ranges::any_of(chart.mesh.faces, [&](const Triangle& face) {
    const auto at = [&](std::size_t k) { return uv[static_cast<std::size_t>(face[k])]; };
    const Vec2 a = at(1) - at(0), b = at(2) - at(0);
    return a.x() * b.y() != a.y() * b.x();
  });
}

void note_islands_without_area(const std::vector<charts::UvIslands>& all, Report& report) {
  std::size_t count = 0;
  for (const charts::UvIslands& islands : all)
    for (std::size_t k = 0; k < islands.maps.size(); ++k)
      count += has_area(islands.charts.charts[k], islands.maps[k]) ? 0 : 1;
  if (count > 0)
    report.notes.push_back({NoteCode::distorted,
                            std::to_string(count) +
                                " islands have no area on the page: their texture coordinates lie "
                                "on a line or a point. Unwrap the asset to give them some."});
}

void measure(std::span<const Surface> surfaces, const std::vector<charts::UvIslands>& all,
             Unwrapped& out) {
  measure::DistortionSums total;
  Report& report = out.report;
  for (std::size_t s = 0; s < all.size(); ++s) {
    const charts::Charts& charts = all[s].charts;
    out.surfaces.push_back(assemble(surfaces[s], charts, all[s].maps));
    const std::vector<double> seams = measure::seam_lengths(surfaces[s], out.surfaces.back());
    report.input.faces += charts.input.faces;
    report.input.vertices += charts.input.vertices;
    for (std::size_t k = 0; k < charts.charts.size(); ++k) {
      UvMap map = all[s].maps[k];
      to_page_widths(map, report.page);
      const double scale = surfaces[s].scale;
      const measure::DistortionSums sums = sums_of(charts.charts[k], map).in_units(scale);
      total += sums;
      report.charts.push_back(report_of(charts.charts[k], sums, s));
      for (const Index t : charts.charts[k].face_source)
        report.charts.back().seam_length += seams[t] * scale;
      report.seam_length += report.charts.back().seam_length / 2;
    }
  }
  report.area = total.area;
  report.distortion = measure::distortion(total);
  if (!(total.area > 0)) return;
  report.seam_ratio = report.seam_length / std::sqrt(total.area);
  report.texel_density = std::sqrt(total.uv_area / total.area) * report.page.width;
}

}  // namespace

Unwrapped repack(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor) {
  const auto announce = [&](Stage stage, double fraction) {
    if (progress.on_stage) progress.on_stage({stage, 0, 0, fraction});
  };
  announce(Stage::setup, 0.05);
  std::vector<charts::UvIslands> all =
      find_islands(surfaces, options.measure_only ? "measure_only" : "repack_only", progress.stop);
  Unwrapped out;
  announce(Stage::pack, 0.2);
  if (options.measure_only)
    leave_in_place(all, options, progress.stop, out.report);
  else if (!options.locked_islands.empty())
    place_around(surfaces, all, options, executor, out.report);
  else
    place(surfaces, all, options, executor, out.report);
  announce(Stage::measure, 0.9);
  note_faces_without(all, out.report);
  note_islands_without_area(all, out.report);
  measure(surfaces, all, out);
  return out;
}

}  // namespace unwrapd::pipeline
