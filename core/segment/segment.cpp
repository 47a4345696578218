// The search, step by step: over-segment by normals; merge greedily; large-neighbourhood search;
// shorten borders; merge again; close slits and attach small charts; bisect; shorten part by part.
// ARAP is the judge of every union. See SurfaceSegmentation::first() and finish().
//
// A looser bound starts from the result of the tighter one and accepts only shorter seams, so that
// no bound costs more seam than a tighter one (ADR 0039). Rejected: a search of its own for every
// bound: of twelve made surfaces one pair of bounds in twelve had longer seams at the looser one,
// by up to a third.
#include "core/segment/segment.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "core/segment/map_anyhow.hpp"
#include "core/segment/search/over_segment.hpp"
#include "core/segment/search/partition_cost.hpp"
#include "core/segment/search/shorten_seams.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kAnyExcess = 1e6, kFarWeight = 10;  // beyond the bound, for a number of regions
constexpr double kLittleExcess = 0.1;
constexpr double kNoiseOfForce = 0.3;
constexpr double kFacesOfQuick = 20, kQuickWeight = 1;
constexpr std::array kSteps = {1.5, 2.0, 2.5, 3.5, 5.0, 7.5, 10.0};  // of excess, in each decade
constexpr std::array kFastSteps = {2.5, 5.0, 10.0};
constexpr int kDecades = 4;
constexpr double kSameBound = 1e-9;

/// Of merging up to so much excess, over budgets.
MergeSettings settings_up_to(double excess) {
  return {.budget = excess, .cap = excess, .distortion_weight = kFarWeight * excess};
}

/// Merges on to the allowed number of regions, at any distortion: within little of it, those that
/// have a sound map side by side, then by force (Joiner::force()); then the same at any. seed: of
/// the order of unions; 0: by what they are worth.
Partition merge_by_force(const MergeContext& context, Partition partition, Index most_regions,
                         int seed, Executor& executor) {
  const Joiner joiner(context.surface);
  for (const double excess : {kLittleExcess, kAnyExcess}) {
    MergeSettings settings = settings_up_to(excess);
    settings.enough = most_regions;
    settings.seed = seed;
    settings.noise = seed == 0 ? 0 : kNoiseOfForce;
    partition = merge_regions(context, joiner, std::move(partition), settings, executor);
    settings.anyhow = [&](std::span<const char> open, Region& region) {
      return map_anyhow(context.surface, open, context.stop, region);
    };
    partition = merge_regions(context, joiner, std::move(partition), settings, executor);
  }
  return partition;
}

/// To the allowed number of regions. Where these have much distortion, or maps that overlap, the
/// same is tried from other partitions, since two regions may fit together nowhere. The one with
/// the least excess stays.
Partition merge_to_limit(const MergeContext& context, std::span<const Partition* const> starts,
                         Index most_regions, Executor& executor) {
  const MergeContext own{context.surface, nullptr, nullptr, context.stop};
  Partition best;
  double least = std::numeric_limits<double>::infinity();
  int seed = 0;
  for (const Partition* start : starts) {
    if (least <= kLittleExcess) break;
    Partition merged = merge_by_force(own, *start, most_regions, seed++, executor);
    const double excess = total_excess(merged.regions).worst();
    if (excess < least || best.regions.empty()) best = std::move(merged), least = excess;
  }
  return best;
}

}  // namespace

SurfaceSegmentation::SurfaceSegmentation(const SegmentationMesh& surface, SegmentRules rules,
                                         std::size_t steps, Executor& executor)
    : surface_(surface),
      rules_(std::move(rules)),
      steps_(steps),
      executor_(executor),
      progress_([this](double share) {
        if (rules_.on_progress) rules_.on_progress(stage_, share);
      }),
      context_{surface, &progress_, nullptr, rules_.stop} {}

Segments SurfaceSegmentation::first(double excess) {
  partition_ = {search::over_segment(context_, excess, executor_),
                std::vector<char>(surface_.length.size(), 0)};
  merge_across_kept_edges();
  stage_ = Stage::merge;
  const MergeSettings settings = settings_for(excess);
  if (rules_.is_quick) return merge_quickly(settings);
  search::MergeSearch& search =
      search_.emplace(context_, partition_, settings,
                      search::SearchPlan{search_extent(rules_.effort), steps_}, executor_);
  competing_ = search.merge_greedily();
  search.search_neighbourhoods(competing_);
  best_ = search.bisect_regions(finish(competing_), rules_.most_regions);
  search::shorten_in_parts(context_, settings, best_.partition);
  return segments_of(best_.partition);
}

/// What this glues, no step of the search parts: steps begin from these regions, and the length of
/// a kept edge is such that no cut along it is the cheaper one.
void SurfaceSegmentation::merge_across_kept_edges() {
  if (surface_.kept.empty()) return;
  const ExcessDistortion before = total_excess(partition_.regions);
  MergeSettings settings = settings_up_to(kAnyExcess);
  settings.only_kept = true;
  partition_ = merge_regions({surface_, nullptr, nullptr, context_.stop}, Joiner(surface_),
                             std::move(partition_), settings, executor_);
  forced_ = std::max(0.0, (total_excess(partition_.regions) - before).worst());
}

/// The cheapest result of all candidates.
search::Candidate SurfaceSegmentation::finish(std::vector<search::Candidate> all) {
  all = search_->shorten_borders(std::move(all));
  all = search_->merge_again(std::move(all));
  all = search_->close_and_attach(std::move(all));
  return search_->cheapest(std::move(all));
}

std::optional<Segments> SurfaceSegmentation::loosen(double excess) {
  search::MergeSearch& search = *search_;
  if (!std::exchange(is_priced_, true)) best_ = search.price(std::move(best_));
  const double seam = best_.cost.length;
  if (seam <= 0) return std::nullopt;  // it needs no cut
  search.widen(settings_for(excess).budget, competing_);
  std::vector<search::Candidate> all = competing_;
  all.push_back(best_);
  search.forbid_seams_from(seam);
  search::Candidate next = finish(std::move(all));
  if (next.cost.length < seam) {
    next = search.bisect_regions(std::move(next), rules_.most_regions);
    search::shorten_in_parts(context_, settings_for(excess), next.partition);
    next = search.price(std::move(next));
  }
  search.forbid_seams_from(std::numeric_limits<double>::infinity());
  if (!(next.cost.length < seam && next.cost.all < best_.cost.all)) return std::nullopt;
  best_ = std::move(next);
  return segments_of(best_.partition);
}

MergeSettings SurfaceSegmentation::settings_for(double excess) const {
  const double budget = kMarginOfExcess * excess;
  MergeSettings settings{.budget = budget + forced_, .cap = kMostOfOneRegion * budget};
  settings.page_area = rules_.page_area;
  return settings;
}

Segments SurfaceSegmentation::merge_quickly(const MergeSettings& settings) {
  progress_.begin(1, kFacesOfQuick * surface_.face_count());
  MergeSettings quick = settings;
  quick.distortion_weight = kQuickWeight;
  return segments_of(
      merge_regions(context_, Joiner(surface_), std::move(partition_), quick, executor_));
}

Segments SurfaceSegmentation::segments_of(Partition best) const {
  if (best.regions.size() > static_cast<std::size_t>(rules_.most_regions)) {
    std::vector<const Partition*> starts{&best};
    if (!competing_.empty()) starts.insert(starts.end(), 3, &competing_.front().partition);
    starts.insert(starts.end(), 2, &partition_);
    best = merge_to_limit(context_, starts, rules_.most_regions, executor_);
  }
  Segments segments{.regions = {},
                    .open = {},
                    .excess = total_excess(best.regions),
                    .seam_length = search::seam_length(surface_, best)};
  segments.open = std::move(best.open);
  for (MappedRegion& region : best.regions) segments.regions.push_back(std::move(region));
  return segments;
}

OnProgress part_of_progress(OnProgress whole, double begin, double end) {
  if (!whole) return whole;
  return [whole = std::move(whole), begin, end](Stage stage, double share) {
    whole(stage, begin + share * (end - begin));
  };
}

OnProgress progress_without_steps_back(OnProgress whole) {
  if (!whole) return whole;
  return [whole = std::move(whole), furthest = std::make_shared<double>(0)](
             Stage stage, double share) { whole(stage, *furthest = std::max(*furthest, share)); };
}

SeamsOfCharts seams_of(const Segments& segments) {
  return {segments.regions.size(), segments.seam_length};
}

bool is_better(const SeamsOfCharts& one, const SeamsOfCharts& other, Index most) {
  const auto beyond = [&](const SeamsOfCharts& own) {
    return std::max(own.charts, static_cast<std::size_t>(most));
  };
  if (beyond(one) != beyond(other)) return beyond(one) < beyond(other);
  return one.length < other.length;
}

std::vector<double> excess_steps(double max_distortion, Effort effort) {
  using Steps = std::span<const double>;
  const Steps of_a_decade = effort == Effort::fast ? Steps(kFastSteps) : Steps(kSteps);
  std::vector<double> steps{std::min(max_distortion, kDefaultDistortion) - 2};
  double decade = kDefaultDistortion - 2;
  for (int k = 0; k < kDecades; ++k, decade *= 10)
    for (const double step : of_a_decade)
      if (2 + step * decade <= max_distortion + kSameBound) steps.push_back(step * decade);
  return steps;
}

std::optional<double> tighter_bound(double max_distortion, Effort effort) {
  const std::vector<double> steps = excess_steps(max_distortion, effort);
  if (steps.size() < 2) return std::nullopt;
  return 2 + steps[steps.size() - 2];
}

Segments segment(const SegmentationMesh& surface, const SegmentRules& rules, Executor& executor) {
  const std::vector<double> steps = excess_steps(rules.max_distortion, rules.effort);
  SurfaceSegmentation segmentation(surface, rules, steps.size() - 1, executor);
  Segments best = segmentation.first(steps.front());
  for (const double excess : std::span(steps).subspan(1)) {
    std::optional<Segments> next = segmentation.loosen(excess);
    if (next && is_better(seams_of(*next), seams_of(best), rules.most_regions))
      best = std::move(*next);
  }
  return best;
}

}  // namespace unwrapd::segment
