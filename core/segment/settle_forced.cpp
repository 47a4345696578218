// A map that overlaps tells little of what the chart will cost without overlaps: two regions that
// close to a bag come to a map a million times too small at its bottom. So each such chart goes
// through the guarantee here, beside the same faces glued together again and cut anew.
#include "core/segment/settle_forced.hpp"

#include <limits>
#include <memory>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/split_chart.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/overlaps.hpp"
#include "core/segment/base/test_parameterization.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::segment {
namespace {

constexpr Index kMostFacesSettled = 50'000;  // a new map of more takes minutes
constexpr double kSettledTolerance = 1e-3;   // of energy, from iteration to iteration
constexpr double kNeverSettled = std::numeric_limits<double>::infinity();

struct Settled {
  charts::Chart chart;
  double excess = kNeverSettled;  ///< of its start, in mesh units
};

UvMap arap_map(const charts::Chart& chart, const solve::Disk& disk, const std::stop_token& stop) {
  UnwrapOptions options;
  options.stop.tolerance = kSettledTolerance;
  solve::ConstrainedStart given;
  if (!chart.start.empty()) given.start = solve::with_unit_area(disk, chart.start);
  SerialExecutor serial;
  solve::SolveWatch watch;
  watch.loop.stop = stop;
  return solve::Solver(disk, options, std::move(given), serial).run(0, watch).uv;
}

/// The chart with a start without overlaps, or as it is where none was found.
Settled settled(charts::Chart chart, const std::stop_token& stop) try {
  if (chart.mesh.face_count() > kMostFacesSettled) return {std::move(chart)};
  const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops, stop);
  const guarantee::GuaranteeRules rules{
      .guarantee = Guarantee::bijective,
      .intent = {.rigidity = {}, .constrained = {}, .stop = stop}};
  guarantee::GuaranteedMap kept = guarantee::keep_guarantee(
      std::make_shared<const charts::Chart>(chart), disk, arap_map(chart, disk, stop), rules);
  if (kept.parts.size() > 1) return {std::move(chart)};
  chart.start = std::move(kept.parts.front().uv);
  chart.least = Guarantee::bijective;
  const double excess =
      excess_of(measure::distortion_sums(disk.rest, disk.faces, chart.start, stop)).worst();
  return {std::move(chart), disk.unit * disk.unit * excess};
} catch (const Error&) {
  throw_if_cancelled(stop);
  return {std::move(chart)};
}

/// The faces of a chart, with no seam but what a disk needs.
charts::Chart cut_anew(const charts::Chart& component, const charts::Chart& chart,
                       const std::stop_token& stop) {
  std::vector<char> is_own(component.mesh.faces.size(), 0);
  std::size_t at = 0;
  for (const Index source : chart.face_source) {  // both ascend
    while (component.face_source[at] != source) ++at;
    is_own[at] = 1;
  }
  Halfedges apart = component.halfedges;
  for (std::size_t h = 0; h < apart.twin.size(); ++h)
    if (const Index twin = apart.twin[h]; twin != kNoTwin && is_own[h / 3] != is_own[face_of(twin)])
      apart.twin[h] = kNoTwin;
  for (charts::ChartPart& part : charts::parts_of(component, apart, stop)) {
    if (is_own[part.face.front()] == 0) continue;
    if (!charts::is_disk(part.chart)) charts::cut(part.chart);
    return std::move(part.chart);
  }
  return chart;
}

bool overlaps(const charts::Chart& chart, const std::stop_token& stop) {
  return !measure::is_plainly_injective(chart.mesh.faces, chart.loops, chart.start, stop);
}

}  // namespace

std::vector<charts::Chart> settle_forced(const charts::Chart& component,
                                         std::vector<charts::Chart> charts,
                                         const std::stop_token& stop) {
  double excess = 0;
  bool were_settled = true;
  for (charts::Chart& chart : charts) {
    if (chart.least == Guarantee::bijective) continue;
    if (!overlaps(chart, stop)) {
      chart.least = Guarantee::bijective;
      continue;
    }
    were_settled = false;
    Settled own{chart};
    if (chart.mesh.face_count() <= kMostFacesSettled) {
      Settled anew = settled(cut_anew(component, chart, stop), stop);
      own = settled(std::move(chart), stop);
      if (anew.excess < own.excess) own = std::move(anew);
    }
    excess += own.excess;
    chart = std::move(own.chart);
  }
  if (were_settled || charts.size() == 1) return charts;
  charts::Chart whole = component;
  if (!charts::is_disk(whole)) charts::cut(whole);
  if (Settled one = settled(std::move(whole), stop); one.excess < excess) {
    charts.clear();
    charts.push_back(std::move(one.chart));
  }
  return charts;
}

}  // namespace unwrapd::segment
