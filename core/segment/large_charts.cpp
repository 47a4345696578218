// The small surface does not show noise and detail, which add distortion to whatever charts there
// are. How much they add is measured first, on charts of one quick merge carried to the large
// surface, and is taken from the bound of the small one. What the charts that are then found come
// to is measured, too; if that misses the bound, they are sought once more for a lower one.
// Rejected: a fixed share of the bound for noise: too much for smooth surfaces, too little for
// rough ones; measuring on the patches before they merge: that shows half of it.
#include "core/segment/large_charts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/segment/chart_excess.hpp"
#include "core/segment/coarsen.hpp"
#include "core/segment/region_charts.hpp"

namespace unwrapd {
namespace {

constexpr Index kFacesOfCoarse = 12'000;
constexpr double kCaution = 1.15;    // for each unit of excess that was measured
constexpr double kMostHidden = 0.7;  // of the excess allowed; where noise takes more, it is let be
constexpr double kRoughShare = 0.1, kFirstShare = 0.9;  // of the work, when they have ended

class Search {
 public:
  Search(const Chart& component, const SegmentRules& rules, Executor& executor)
      : component_(component),
        rules_(rules),
        executor_(executor),
        coarse_(coarsen(component.mesh, component.halfedges, kFacesOfCoarse, rules.stop)),
        sheet_(make_sheet(coarse_.mesh, coarse_.halfedges)) {}

  LargeCharts run() {
    const double most = rules_.max_distortion - 2;
    const Found quick = find(0, true, {0, kRoughShare});
    double hidden = kCaution * std::max(0.0, (quick.large - quick.small).worst());
    const bool is_rough = hidden > kMostHidden * most;
    if (is_rough) hidden = 0;
    Found found = find(hidden, false, {kRoughShare, kFirstShare});
    const double missed = found.large.worst() - most;
    const bool is_limited = std::ssize(found.charts) >= rules_.most_regions;
    if (missed > 0 && !is_rough && !is_limited) {
      hidden = std::min(hidden + kCaution * missed, kMostHidden * most);
      found = find(hidden, false, {kFirstShare, 1});
    }
    return {std::move(found.charts), is_rough};
  }

 private:
  struct Found {
    std::vector<Chart> charts;
    Excess small, large;  ///< on either surface, over its area
  };
  struct Span {
    double begin, end;
  };

  /// hidden: the excess that is kept from the small surface.
  Found find(double hidden, bool is_quick, const Span& work) {
    SegmentRules rules = rules_;
    rules.max_distortion -= hidden;
    rules.first_distortion = std::numeric_limits<double>::infinity();
    rules.is_quick = is_quick;
    rules.on_progress = [&](Stage stage, double share) {
      if (rules_.on_progress)
        rules_.on_progress(stage, work.begin + share * (work.end - work.begin));
    };
    const Segments segments = segment(sheet_, rules, executor_);
    Found found{region_charts(component_, coarse_, segments, rules_.stop), segments.excess, {}};
    found.large = chart_excess(found.charts, executor_, rules_.stop);
    return found;
  }

  const Chart& component_;
  const SegmentRules& rules_;
  Executor& executor_;
  Coarse coarse_;
  Sheet sheet_;
};

}  // namespace

LargeCharts large_charts(const Chart& component, const SegmentRules& rules, Executor& executor) {
  return Search(component, rules, executor).run();
}

}  // namespace unwrapd
