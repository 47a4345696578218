// Whether to take a component apart is a rule, not a guess: a disk is what someone opened on
// purpose, or what needs no seam, and stays one chart unless a bound of distortion is asked for.
// Everything else needs seams anyway, and then the best ones. So does a disk whose boundary is a
// mere puncture: by the isoperimetric inequality it would have to be drawn out tenfold to enclose
// the disk's area. Where a component shall be one chart and no bound is asked for, it is cut to a
// disk. So is one that merging leaves in too many charts, if that disk has a sound map.
#include "core/segment/segment_charts.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/segment/account.hpp"
#include "core/segment/component_charts.hpp"
#include "core/segment/region_charts.hpp"
#include "core/segment/shared_segments.hpp"
#include "core/segment/whole_chart.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kLeastOpenness = 0.01;  // 1 / 10^2
constexpr double kShareOfFirst = 0.25;   // of the work, to share charts out
constexpr double kMostOfCut = 100;       // distortion of a chart instead of too many

/// The square of how long the boundary is beside that of a flat round disk of the same area.
double openness(const charts::Chart& component) {
  const double length = boundary_length(component);
  return length * length / (4 * std::numbers::pi * measure::surface_area(component.mesh));
}

void note(charts::Charts& surface, RepairKind kind, Index count) {
  if (count > 0) surface.repairs.push_back({kind, 0, count});
}

/// How many charts each component may become, in the order of surfaces and components.
struct Quotas {
  std::vector<Index> most;
  bool merges_to_one = false;  ///< 1: searched at the bound that is asked for, too
  bool is_last = true;         ///< not only to see how many charts the components would like
};

/// What is done with the components of a surface, one after another.
class Cutter {
 public:
  /// scale: of the surface.
  Cutter(const SegmentOptions& options, const Quotas& quotas, double scale, const Account& account,
         Executor& executor)
      : options_(options), quotas_(quotas), scale_(scale), account_(account), executor_(executor) {}

  [[nodiscard]] bool is_segmented(const charts::Chart& component, Index most) const {
    if (options_.one_chart_each) return false;
    const bool is_disk = charts::is_disk(component);
    if (is_one(most)) return options_.max_distortion.has_value();
    return !is_disk || options_.max_distortion || openness(component) < kLeastOpenness;
  }

  [[nodiscard]] ComponentRules rules_of(const charts::Chart& component, Index most) const {
    const bool has_bound = options_.max_distortion && !is_one(most);
    const double bound = has_bound ? *options_.max_distortion : kDefaultDistortion;
    SegmentRules rules = account_.rules(bound, component, scale_);
    rules.most_regions = most;
    rules.effort = options_.effort;
    const bool may_stay = charts::is_disk(component) && openness(component) >= kLeastOpenness;
    return {rules, options_.symmetry, may_stay};
  }

  /// most: charts that it shall become at most.
  void add(charts::Chart component, Index most) {
    throw_if_cancelled(account_.stop());
    if (is_segmented(component, most))
      return take(std::move(component), most,
                  charts_within_bound(component, rules_of(component, most), executor_));
    add_whole(std::move(component));
  }

  /// A component and the charts that the search has found for it.
  void take(charts::Chart component, Index most, ComponentCharts parts) {
    const bool are_too_many = static_cast<Index>(parts.charts.size()) > most;
    if (are_too_many && (is_one(most) || (quotas_.is_last && is_sound_when_cut(component))))
      return add_whole(std::move(component));
    rough += parts.is_rough ? 1 : 0;
    segmented += !charts::is_disk(component) || parts.charts.size() > 1 ? 1 : 0;
    for (charts::Chart& part : parts.charts) charts.push_back(std::move(part));
  }

  std::vector<charts::Chart> charts;
  Index cuts = 0, segmented = 0, rough = 0;

 private:
  /// Merging may leave too many charts, as where seams come from a smaller surface. A cut may still
  /// have a sound map.
  [[nodiscard]] bool is_sound_when_cut(charts::Chart component) const {
    if (!charts::is_disk(component)) charts::cut(component);
    return map_whole(component, kMostOfCut, executor_, account_.stop()).has_value();
  }

  void add_whole(charts::Chart component) {
    if (!charts::is_disk(component)) {
      charts::cut(component);
      ++cuts;
    }
    charts.push_back(std::move(component));
  }

  /// One chart. With a bound it is the search's at kDefaultDistortion, whatever the bound
  /// (ADR 0039); without one it is a cut.
  [[nodiscard]] bool is_one(Index most) const { return most == 1 && !quotas_.merges_to_one; }

  const SegmentOptions& options_;
  const Quotas& quotas_;
  double scale_;
  const Account& account_;
  Executor& executor_;
};

/// What cutting came to.
struct Cuts {
  std::vector<Index> became;       ///< how many charts each component
  std::vector<std::size_t> faces;  ///< of each component
  Index rough = 0;                 ///< components where noise leaves no room for the bound

  [[nodiscard]] Index charts() const {
    return std::accumulate(became.begin(), became.end(), Index(0));
  }
};

/// The charts of the components that are segmented, where other processes help with them: one a
/// component, in the order of surfaces, empty for those that are not. Else nothing. make_cutter():
/// of a surface.
template <class MakeCutter>
std::vector<std::optional<ComponentCharts>> segment_together(
    const std::vector<charts::Charts>& surfaces, const Quotas& quotas,
    const MakeCutter& make_cutter, Account& account, Executor& executor) {
  if (executor.shared_work() == nullptr) return {};
  std::vector<ComponentJob> jobs;
  std::vector<std::size_t> places;
  std::size_t place = 0;
  for (const charts::Charts& surface : surfaces) {
    const Cutter cutter = make_cutter(surface);
    for (const charts::Chart& component : surface.charts) {
      const Index most = quotas.most[place++];
      if (!cutter.is_segmented(component, most)) continue;
      jobs.push_back({&component, cutter.rules_of(component, most)});
      places.push_back(place - 1);
    }
  }
  const auto on_done = [&](std::size_t job) {
    account.finish(jobs[job].component->mesh.faces.size());
    account.tell();
  };
  std::vector<ComponentCharts> made = charts_made_together(jobs, on_done, executor);
  if (made.empty()) return {};
  std::vector<std::optional<ComponentCharts>> all(place);
  for (std::size_t k = 0; k < made.size(); ++k) all[places[k]] = std::move(made[k]);
  return all;
}

Cuts cut_all(std::vector<charts::Charts>& surfaces, const Quotas& quotas,
             const SegmentOptions& options, const SegmentWatch& watch, Executor& executor) {
  Account account(surfaces, watch);
  const auto make_cutter = [&](const charts::Charts& surface) {
    return Cutter(options, quotas, surface.scale, account, executor);
  };
  auto made = segment_together(surfaces, quotas, make_cutter, account, executor);
  made.resize(quotas.most.size());
  Cuts cuts;
  for (charts::Charts& surface : surfaces) {
    Cutter cutter = make_cutter(surface);
    for (charts::Chart& component : std::exchange(surface.charts, {})) {
      const std::size_t place = cuts.became.size(), before = cutter.charts.size();
      const std::size_t faces = component.mesh.faces.size();
      if (made[place]) {
        cutter.take(std::move(component), quotas.most[place], std::move(*made[place]));
      } else {
        cutter.add(std::move(component), quotas.most[place]);
        account.finish(faces);
      }
      cuts.became.push_back(static_cast<Index>(cutter.charts.size() - before));
      cuts.faces.push_back(faces);
    }
    surface.charts = std::move(cutter.charts);
    cuts.rough += cutter.rough;
    note(surface, RepairKind::cut_to_disk, cutter.cuts);
    note(surface, RepairKind::segmented, cutter.segmented);
  }
  return cuts;
}

std::size_t count_of(const std::vector<charts::Charts>& surfaces) {
  std::size_t components = 0;
  for (const charts::Charts& surface : surfaces) components += surface.charts.size();
  return components;
}

/// One chart for each component; what is left of `most` goes by how many they would like, and what
/// rounding leaves of that to those that are furthest from it, of these to the ones of most faces.
Quotas shared_out(const Cuts& wanted, Index most) {
  Quotas quotas{wanted.became, wanted.charts() <= most};
  const auto count = static_cast<Index>(quotas.most.size());
  const std::int64_t spare = std::max(most - count, 0), all = std::max(wanted.charts() - count, 1);
  struct Missing {
    std::int64_t share = 0;  // of a chart
    std::size_t faces = 0, component = 0;
  };
  std::vector<Missing> missing;
  std::int64_t left = wanted.charts() > count ? spare : 0;
  for (std::size_t k = 0; k < quotas.most.size(); ++k) {
    const std::int64_t share = spare * (wanted.became[k] - 1);
    quotas.most[k] = 1 + static_cast<Index>(share / all);
    left -= share / all;
    missing.push_back({share % all, wanted.faces[k], k});
  }
  std::ranges::stable_sort(missing, std::greater(),
                           [](const Missing& own) { return std::pair(own.share, own.faces); });
  for (std::int64_t k = 0; k < left; ++k)
    ++quotas.most[missing[static_cast<std::size_t>(k)].component];
  return quotas;
}

SegmentWatch part_of(const SegmentWatch& watch, double begin, double end) {
  return {part_of_progress(watch.on_progress, begin, end), watch.stop};
}

/// All surfaces, of which no more than `most` charts shall be made. How these are shared out is
/// decided at kDefaultDistortion and holds for all bounds: what each component comes to then
/// follows the steps (ADR 0039).
Cuts cut_to_most(std::vector<charts::Charts>& surfaces, const SegmentOptions& options,
                 const SegmentWatch& watch, Executor& executor) {
  const Index most = *options.max_charts;
  const std::size_t components = count_of(surfaces);
  const Index each = std::max<Index>(most - static_cast<Index>(components) + 1, 1);
  const bool has_steps = components > 1 && each > 1 &&
                         options.max_distortion.value_or(kDefaultDistortion) != kDefaultDistortion;
  SegmentOptions first = options;
  if (has_steps) first.max_distortion = kDefaultDistortion;
  const std::vector<charts::Charts> whole = surfaces;
  const SegmentWatch begin = has_steps ? part_of(watch, 0, kShareOfFirst) : watch;
  const Quotas quotas{std::vector<Index>(components, each), false, components == 1};
  Cuts cuts = cut_all(surfaces, quotas, first, begin, executor);
  if (each == 1 || components == 1 || (cuts.charts() <= most && !has_steps)) return cuts;
  surfaces = whole;
  const SegmentWatch rest =
      has_steps ? part_of(watch, kShareOfFirst, 1) : SegmentWatch{{}, watch.stop};
  return cut_all(surfaces, shared_out(cuts, most), options, rest, executor);
}

Note more_than_asked(Index charts, Index components, Index most) {
  const std::string why = components > most
                              ? "the mesh has " + std::to_string(components) + " components"
                              : "no map without overlaps was found for so few";
  return {NoteCode::charts_exceeded, "The surface needs more charts than max_charts: " +
                                         std::to_string(charts) + ", because " + why + "."};
}

Note rough_surfaces(Index count) {
  return {NoteCode::surface_noisy,
          "The noise of " + std::to_string(count) +
              " of the surfaces leaves no room for max_distortion; the bound holds on a smoothed "
              "surface instead."};
}

}  // namespace

std::optional<Note> segment_charts(std::vector<charts::Charts>& surfaces,
                                   const SegmentOptions& options, const SegmentWatch& watch,
                                   Executor& executor) {
  const std::size_t components = count_of(surfaces);
  const Index most = options.max_charts.value_or(std::numeric_limits<Index>::max());
  const SegmentWatch own{progress_without_steps_back(watch.on_progress), watch.stop};
  const Cuts cuts = options.max_charts ? cut_to_most(surfaces, options, own, executor)
                                       : cut_all(surfaces, {std::vector<Index>(components, most)},
                                                 options, own, executor);
  if (cuts.charts() > most)
    return more_than_asked(cuts.charts(), static_cast<Index>(components), most);
  if (cuts.rough > 0) return rough_surfaces(cuts.rough);
  return std::nullopt;
}

}  // namespace unwrapd::segment
