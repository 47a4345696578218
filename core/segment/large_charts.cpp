// The small surface does not show noise and detail, which add distortion to whatever charts there
// are. How much they add is measured first, on charts of one quick merge carried to the large
// surface, and is taken from the bound of the small one. What the charts that are then found come
// to is measured, too; if that misses the bound, they are sought once more for a lower one.
// Rejected: a fixed share of the bound for noise: too much for smooth surfaces, too little for
// rough ones; measuring on the regions before they merge: that shows half of it.
//
// For a looser bound the noise is measured at the first of its steps and the search goes on from
// step to step (ADR 0039); what is then compared are the seams on the large surface.
#include "core/segment/large_charts.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "core/segment/chart_excess.hpp"
#include "core/segment/coarsen.hpp"
#include "core/segment/region_charts.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kCaution = 1.15;    // for each unit of excess that was measured
constexpr double kMostHidden = 0.7;  // of the excess allowed; where noise takes more, it is let be
constexpr double kMostKept = 0.25;   // edges that are kept, for each face of the small surface
constexpr double kRoughShare = 0.1, kFirstShare = 0.9;  // of the work, when they have ended

double kept_edges_of(const charts::Chart& component) {
  return static_cast<double>(
             std::ranges::count_if(component.avoid, [](double v) { return v > 1; })) /
         2;
}

/// Where many edges are kept, too few could be contracted: seams then follow them at a high cost.
Coarse coarse_of(const charts::Chart& component, Index faces, const std::stop_token& stop) {
  const std::span<const double> avoid = component.avoid;
  const bool are_few = kept_edges_of(component) <= kMostKept * faces;
  Coarse coarse = coarsen(component.mesh, component.halfedges, faces, stop,
                          are_few ? avoid : std::span<const double>());
  coarse.avoid = component.avoid;
  return coarse;
}

/// What charts are found, step by step (excess_steps()).
class Search {
 public:
  Search(const charts::Chart& component, const SegmentRules& rules, Index faces, Executor& executor)
      : component_(component),
        rules_(rules),
        executor_(executor),
        coarse_(coarse_of(component, faces, rules.stop)),
        surface_(
            make_segmentation_mesh(coarse_.mesh, coarse_.halfedges, {},
                                   coarse_avoid(coarse_, component.mesh, component.halfedges))),
        steps_(excess_steps(rules.max_distortion, rules.effort)) {}

  /// Measures what the small surface hides: whether that leaves room for the first of the steps.
  bool has_room() {
    const double excess = steps_.front();
    measure_hidden();
    return steps_.front() == excess && !is_rough_;
  }

  /// After has_room().
  LargeCharts run() { return {loosened(first()), is_rough_}; }

  std::optional<std::vector<charts::Chart>> run_within_bound() {
    const double excess = steps_.front();
    if (!has_room()) return std::nullopt;
    Found found = first();
    if (misses(found, excess)) return std::nullopt;
    return loosened(std::move(found));
  }

 private:
  struct Found {
    std::vector<charts::Chart> charts;
    ExcessDistortion small, large;  ///< on either surface, over its area
    SeamsOfCharts seams;            ///< weighted_boundary() of all charts
    std::vector<double> excess;     ///< of each chart, on the large surface
  };

  std::vector<charts::Chart> loosened(Found best) {
    for (std::size_t k = 1; k < steps_.size(); ++k) {
      std::optional<Found> next = loosen(steps_[k]);
      if (next && is_better(next->seams, best.seams, rules_.most_regions)) best = std::move(*next);
    }
    return std::move(best.charts);
  }

  /// Steps for which the noise leaves no room are left out, unless that is so for all of them.
  void measure_hidden() {
    begin(0, true, kRoughShare);
    const Found quick = on_large(segmentation_->first(steps_.front()));
    hidden_ = kCaution * std::max(0.0, (quick.large - quick.small).worst());
    const auto with_room = std::ranges::find_if(
        steps_, [&](double excess) { return hidden_ <= kMostHidden * excess; });
    is_rough_ = with_room == steps_.end();
    if (is_rough_)
      hidden_ = 0;
    else
      steps_.erase(steps_.begin(), with_room);
  }

  Found first() {
    const double excess = steps_.front();
    begin(steps_.size() - 1, false, kFirstShare);
    last_ = on_small(excess);
    Found found = on_large(segmentation_->first(last_));
    if (misses(found, excess)) {
      hide_more(found, excess);
      begin(steps_.size() - 1, false, 1);
      last_ = on_small(excess);
      found = on_large(segmentation_->first(last_));
    }
    split_distorted(found, excess);
    return found;
  }

  /// Nothing where there are no other charts, or they do not keep the bound; then more is kept from
  /// the small surface in steps to come.
  std::optional<Found> loosen(double excess) {
    if (on_small(excess) <= last_) return std::nullopt;
    const std::optional<Segments> segments = segmentation_->loosen(on_small(excess));
    last_ = on_small(excess);
    if (!segments) return std::nullopt;
    Found found = on_large(*segments);
    if (misses(found, excess)) {
      hide_more(found, excess);
      return std::nullopt;
    }
    split_distorted(found, excess);
    return found;
  }

  /// The work up to the share `end` begins: a segmentation of the small surface.
  void begin(std::size_t steps, bool is_quick, double end) {
    SegmentRules rules = rules_;
    rules.is_quick = is_quick;
    if (is_quick) rules.most_regions = std::numeric_limits<Index>::max();
    rules.on_progress = [this, begin = done_, end](Stage stage, double share) {
      done_ = begin + share * (end - begin);
      if (rules_.on_progress) rules_.on_progress(stage, done_);
    };
    segmentation_.emplace(surface_, std::move(rules), steps, executor_);
  }

  Found on_large(const Segments& segments) {
    Found found{
        region_charts(component_, coarse_, segments, rules_.stop), segments.excess, {}, {}, {}};
    ChartExcess excess = chart_excess(found.charts, executor_, rules_.stop);
    found.large = excess.mean;
    found.excess = std::move(excess.of_each);
    found.seams = seams_of(found.charts);
    return found;
  }

  /// Charts that are distorted beyond what one may have, since the small surface hid it, are
  /// segmented as they are. Rejected: halving them, which finds no sound halves for a third.
  void split_distorted(Found& found, double excess) const {
    if (is_rough_) return;
    const double most = kMostOfOneRegion * excess + segmentation_->forced_excess();
    std::vector<charts::Chart> all;
    for (std::size_t k = 0; k < found.charts.size(); ++k) {
      charts::Chart& chart = found.charts[k];
      const auto others = static_cast<Index>(all.size() + found.charts.size() - k - 1);
      std::vector<charts::Chart> parts;
      if (found.excess[k] > most && others + 1 < rules_.most_regions)
        parts = parts_of(chart, excess, rules_.most_regions - others);
      if (parts.empty()) parts.push_back(std::move(chart));
      for (charts::Chart& part : parts) all.push_back(std::move(part));
    }
    found.charts = std::move(all);
    found.seams = seams_of(found.charts);
    found.excess.clear();
  }

  /// None where the chart has too many faces for that.
  [[nodiscard]] std::vector<charts::Chart> parts_of(const charts::Chart& chart, double excess,
                                                    Index most) const {
    if (chart.mesh.face_count() > search_extent(rules_.effort).second.beyond) return {};
    SegmentRules rules = rules_of_chart(rules_, component_, chart);
    rules.max_distortion = std::min(2 + excess, kDefaultDistortion);
    rules.most_regions = most;
    rules.on_progress = {};
    const charts::Chart alone = as_component(component_, chart);
    return region_charts(alone, segment(make_segmentation_mesh(alone), rules, executor_));
  }

  /// What the small surface may have where the large one may have so much. Rounded as a bound of
  /// distortion is, of which the excess is taken.
  [[nodiscard]] double on_small(double excess) const { return 2 + excess - hidden_ - 2; }

  [[nodiscard]] bool misses(const Found& found, double excess) const {
    const bool is_limited = std::ssize(found.charts) >= rules_.most_regions;
    return !is_rough_ && !is_limited &&
           found.large.worst() > excess + segmentation_->forced_excess();
  }

  void hide_more(const Found& found, double excess) {
    const double missed = found.large.worst() - excess - segmentation_->forced_excess();
    hidden_ = std::min(hidden_ + kCaution * missed, kMostHidden * excess);
  }

  const charts::Chart& component_;
  const SegmentRules& rules_;
  Executor& executor_;
  Coarse coarse_;
  SegmentationMesh surface_;
  std::vector<double> steps_;  ///< that are searched for
  double hidden_ = 0;          ///< of the excess: kept from the small surface
  bool is_rough_ = false;
  double done_ = 0;  ///< share of the work
  double last_ = 0;  ///< excess that was searched for last
  std::optional<SurfaceSegmentation> segmentation_;
};

}  // namespace

LargeCharts large_charts(const charts::Chart& component, const SegmentRules& rules,
                         const StandIn& small, Executor& executor) {
  Search search(component, rules, small.faces, executor);
  if (search.has_room() || small.finer == 0) return search.run();
  Search finer(component, rules, small.finer, executor);
  return finer.has_room() ? finer.run() : search.run();
}

std::optional<std::vector<charts::Chart>> large_charts_within_bound(const charts::Chart& component,
                                                                    const SegmentRules& rules,
                                                                    Index faces,
                                                                    Executor& executor) {
  return Search(component, rules, faces, executor).run_within_bound();
}

}  // namespace unwrapd::segment
