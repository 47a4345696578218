#include "core/segment/tighten.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/measure/rest_triangle.hpp"
#include "core/segment/chart_excess.hpp"
#include "core/segment/segment.hpp"

namespace unwrapd::segment {
namespace {

constexpr std::array kTightBounds = {2.01, 2.005, 2.002, 2.001, 2.0005, 2.0002, 2.0001};

struct Weighed {
  charts::Chart chart;
  double area = 0;    ///< in space
  double excess = 0;  ///< of the chart alone, times its area
  bool may_be_split = true;

  [[nodiscard]] double mean() const { return excess / area; }
};

Weighed weighed(charts::Chart chart, Executor& executor, const std::stop_token& stop) {
  Weighed own{std::move(chart)};
  own.area = measure::surface_area(own.chart.mesh);
  own.excess = own.area * chart_excess(std::span(&own.chart, 1), executor, stop).mean.worst();
  return own;
}

/// What each chart to split may have, if all others stay: those beyond it are to be split.
double level_of(const std::vector<Weighed>& charts, double budget) {
  std::vector<const Weighed*> order;
  double allowed = 0, area = 0;
  for (const Weighed& own : charts) {
    allowed += budget * own.area - (own.may_be_split ? 0 : own.excess);
    if (!own.may_be_split) continue;
    order.push_back(&own);
    area += own.area;
  }
  std::ranges::stable_sort(order, {}, &Weighed::mean);
  for (const Weighed* own : order) {
    if (own->mean() * area > allowed) return std::max(allowed, 0.0) / area;
    allowed -= own->excess;
    area -= own->area;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

TightBounds tight_bounds(double max_distortion, Effort effort) {
  TightBounds bounds;
  if (max_distortion >= kDefaultDistortion) return bounds;
  const auto last =
      std::ranges::find_if(kTightBounds, [&](double bound) { return bound <= max_distortion; });
  const std::ptrdiff_t steps = std::min(last, kTightBounds.end() - 1) - kTightBounds.begin() + 1;
  bounds.count = static_cast<std::size_t>(steps);
  bounds.searched.assign(kTightBounds.begin(), kTightBounds.begin() + steps);
  if (effort != Effort::fast && bounds.count < kTightBounds.size())
    bounds.searched.push_back(kTightBounds[bounds.count]);
  return bounds;
}

std::vector<charts::Chart> tighten(std::vector<charts::Chart> charts, double bound, Index most,
                                   const SplitChart& split, Executor& executor,
                                   const std::stop_token& stop) {
  std::vector<Weighed> all;
  for (charts::Chart& chart : charts) all.push_back(weighed(std::move(chart), executor, stop));
  for (;;) {
    const double level = level_of(all, kMarginOfExcess * (bound - 2));
    const auto worst = std::ranges::max_element(
        all, {}, [](const Weighed& own) { return own.may_be_split ? own.mean() : 0; });
    if (!worst->may_be_split || worst->mean() <= level) break;
    worst->may_be_split = false;
    std::vector<charts::Chart> parts = split(worst->chart, 2 + level / kMarginOfExcess);
    if (all.size() + parts.size() - 1 > static_cast<std::size_t>(most)) continue;
    all.erase(worst);
    for (charts::Chart& part : parts) {
      all.push_back(weighed(std::move(part), executor, stop));
      all.back().may_be_split = false;
    }
  }
  std::ranges::sort(all, {}, [](const Weighed& own) { return own.chart.face_source.front(); });
  charts.clear();
  for (Weighed& own : all) charts.push_back(std::move(own.chart));
  return charts;
}

}  // namespace unwrapd::segment
