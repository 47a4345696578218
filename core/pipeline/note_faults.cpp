#include "core/pipeline/note_faults.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "core/measure/page_area.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kSlack = 0.001;  // of D: rounding to the page moves it less
constexpr double kSlackOfExcess = 0.05;

double worst_of(const Distortion& distortion) {
  return std::max(distortion.angle, distortion.area);
}

/// A figure with so many digits that a reader needs.
std::string short_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

/// The mean of the chart's corners in space.
Vec3 middle_of(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (const Triangle& face : mesh.faces)
    for (const Index v : face) sum += mesh.positions[v];
  return sum / (3.0 * static_cast<double>(mesh.faces.size()));
}

/// "chart 3, on /meshes/0 near (0.1, 2, 3), with D_angle 2.31 and D_area 2.05".
std::string described(const Layout& layout, std::span<const Surface> surfaces, std::size_t chart) {
  const ChartReport& report = layout.report.charts[chart];
  const auto surface = static_cast<std::size_t>(report.surface);
  std::size_t first = 0;
  for (std::size_t s = 0; s < surface; ++s) first += layout.charts[s].size();
  const Vec3 middle = middle_of(layout.charts[surface][chart - first]->mesh);
  return "chart " + std::to_string(chart) + ", on " + surfaces[surface].name + " near (" +
         short_text(middle.x()) + ", " + short_text(middle.y()) + ", " + short_text(middle.z()) +
         "), with D_angle " + short_text(report.distortion.angle) + " and D_area " +
         short_text(report.distortion.area);
}

/// Advice for options under which charts are not split. Both may have to change.
std::string advice_to_split(const UnwrapOptions& options) {
  constexpr const char* kSplit = "send max_distortion=2.02 to split such charts.";
  if (options.keeps_uvs())
    return std::string(" Leave out ") + (options.measure_only ? "measure_only" : "repack_only") +
           ", which keeps the charts as they are, and " + kSplit;
  if (keeps_whole(options))
    return std::string(" Leave out ") + (options.constraints.empty() ? "boundary" : "constraints") +
           ", which keeps such charts whole, and " + kSplit;
  if (options.max_charts)
    return " Send max_distortion=2.02 and max_charts=none to split such charts.";
  return " Send max_distortion=2.02 to split such charts.";
}

std::string advice_on_distortion(const UnwrapOptions& options, std::size_t charts) {
  if (!options.max_distortion) return advice_to_split(options);
  if (options.max_charts && std::cmp_greater_equal(charts, *options.max_charts))
    return " max_charts leaves no room for the bound.";
  if (options.method != Method::arap)
    return " The bound holds for maps of method=arap; other methods trade areas for angles.";
  if (!options.keep_edges.empty())
    return " Charts are held together at edges of keep_edges, whatever the bound: keep fewer.";
  if (options.welding.mode == WeldMode::distance)
    return " Charts keep the bound where corners are welded, not on those of the file: send a "
           "smaller weld_distance.";
  return "";
}

void note_distortion(Layout& layout, std::span<const Surface> surfaces,
                     const UnwrapOptions& options) {
  const double bearable = std::max(kBearableDistortion, options.max_distortion.value_or(0));
  const std::vector<ChartReport>& charts = layout.report.charts;
  const auto worse = [](const ChartReport& a, const ChartReport& b) {
    return worst_of(a.distortion) < worst_of(b.distortion);
  };
  const auto count = std::ranges::count_if(charts, [&](const ChartReport& chart) {
    return worst_of(chart.distortion) > bearable + kSlack;
  });
  const double bound = options.max_distortion.value_or(std::numeric_limits<double>::infinity());
  const bool is_missed =
      worst_of(layout.report.distortion) > bound + std::min(kSlack, kSlackOfExcess * (bound - 2));
  if (count == 0 && !is_missed) return;
  const auto worst =
      static_cast<std::size_t>(std::ranges::max_element(charts, worse) - charts.begin());
  const std::string what = is_missed
                               ? "The mean distortion is beyond max_distortion."
                               : std::to_string(count) + " of " + std::to_string(charts.size()) +
                                     " charts are distorted beyond " + short_text(bearable) + ".";
  layout.report.notes.push_back(
      {NoteCode::distorted, what + " The worst is " + described(layout, surfaces, worst) + "." +
                                advice_on_distortion(options, charts.size())});
}

void note_overlaps(Layout& layout, std::span<const Surface> surfaces) {
  const std::vector<ChartReport>& charts = layout.report.charts;
  const auto pairs = [](const ChartReport& chart) { return chart.overlaps.value_or(0); };
  Index all = 0;
  for (const ChartReport& chart : charts) all += pairs(chart);
  if (all == 0) return;
  const auto worst =
      static_cast<std::size_t>(std::ranges::max_element(charts, {}, pairs) - charts.begin());
  layout.report.notes.push_back(
      {NoteCode::overlaps,
       std::to_string(all) +
           " pairs of triangles overlap, so that they share texels. Most are in " +
           described(layout, surfaces, worst) + ". Send guarantee=bijective to prevent overlaps."});
}

void note_absent_uvs(Layout& layout, std::span<const Surface> surfaces,
                     const UnwrapOptions& options) {
  const auto has_none = [](const Surface& surface) { return surface.corner_uv.empty(); };
  if (options.seams != SeamMode::uv0 || !std::ranges::all_of(surfaces, has_none)) return;
  layout.report.notes.push_back(
      {NoteCode::option_unused,
       "The option seams=uv0 has no effect without texture coordinates in the asset; the cuts are "
       "those of seams=auto."});
}

/// Islands whose colours no texel of their own can hold.
void note_tiny_islands(Layout& layout) {
  const PageSize& page = layout.report.page;
  const double texel = 1.0 / (static_cast<double>(page.width) * page.height);
  std::size_t count = 0;
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k)
      count += measure::page_area(layout.charts[s][k]->mesh.faces, layout.islands[s][k]) < texel;
  if (count == 0) return;
  layout.report.notes.push_back(
      {NoteCode::islands_tiny,
       std::to_string(count) + " of " + std::to_string(layout.report.charts.size()) +
           " islands have less area than one texel of the page, so small are they beside the "
           "others. Send a higher resolution, or unwrap small and large parts apart."});
}

}  // namespace

void note_faults(Layout& layout, std::span<const Surface> surfaces, const UnwrapOptions& options) {
  note_absent_uvs(layout, surfaces, options);
  note_distortion(layout, surfaces, options);
  note_overlaps(layout, surfaces);
  note_tiny_islands(layout);
}

}  // namespace unwrapd::pipeline
