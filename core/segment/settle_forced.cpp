// A map that overlaps tells little of what the chart will cost without overlaps: two regions that
// close to a bag come to a map a million times too small at its bottom.
#include "core/segment/settle_forced.hpp"

#include <limits>
#include <utility>

#include "core/measure/distortion.hpp"
#include "core/measure/overlaps.hpp"
#include "core/segment/base/test_parameterization.hpp"
#include "core/solve/repair/bijective.hpp"

namespace unwrapd::segment {
namespace {

constexpr Index kMostFacesSettled = 50'000;  // a new map of more takes minutes

/// Of a map without overlaps, in mesh units; infinite, with `start` as it was, where none was
/// found.
double excess_when_settled(const charts::Chart& chart, const std::stop_token& stop, UvMap& start) {
  if (chart.mesh.face_count() > kMostFacesSettled) return std::numeric_limits<double>::infinity();
  const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops, stop);
  UvMap uv = start;
  if (uv.empty())
    for (const Vec3& p : disk.positions) uv.push_back(p.head<2>());
  if (!solve::repair::map_injectively(disk, {.rigidity = {}, .constrained = {}, .stop = stop}, uv))
    return std::numeric_limits<double>::infinity();
  const measure::DistortionSums sums = measure::distortion_sums(disk.rest, disk.faces, uv, stop);
  start = std::move(uv);
  return disk.unit * disk.unit * excess_of(sums).worst();
}

bool overlaps(const charts::Chart& chart, const std::stop_token& stop) {
  return chart.least != Guarantee::bijective &&
         !measure::is_plainly_injective(chart.mesh.faces, chart.loops, chart.start, stop);
}

}  // namespace

std::vector<charts::Chart> settle_forced(const charts::Chart& component,
                                         std::vector<charts::Chart> charts,
                                         const std::stop_token& stop) {
  bool are_settled = true;
  double excess = 0;
  for (charts::Chart& chart : charts) {
    if (!overlaps(chart, stop)) continue;
    are_settled = false;
    excess += excess_when_settled(chart, stop, chart.start);
  }
  if (are_settled) return charts;
  charts::Chart whole = component;
  if (!charts::is_disk(whole)) charts::cut(whole);
  UvMap start;
  if (excess <= excess_when_settled(whole, stop, start) &&
      excess < std::numeric_limits<double>::infinity())
    return charts;
  charts.clear();
  charts.push_back(std::move(whole));
  return charts;
}

}  // namespace unwrapd::segment
