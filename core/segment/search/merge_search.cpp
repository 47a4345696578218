// The result of a greedy merge depends on how distortion is weighed against border, and no weight
// is best for all shapes, so several are tried. Results are compared by what a user sees: seams,
// number of charts, and how well a rough packing fills, since few wide charts of the shape of stars
// or rings leave the page empty. Some of the merges refuse such charts from the start. Rejected:
// roundness in the order of unions: small charts on the way are seldom round, and only large charts
// decide the fill.
#include "core/segment/search/merge_search.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/segment/search/attach_small_charts.hpp"
#include "core/segment/search/bisect.hpp"
#include "core/segment/search/close_slits.hpp"
#include "core/segment/search/destroy.hpp"
#include "core/segment/search/shorten_seams.hpp"
#include "core/solve/base/parallel_map.hpp"

namespace unwrapd::segment::search {
namespace {

/// What differs between the greedy merges, see MergeSettings.
struct Weights {
  double distortion = 0, least_fill = 0, least_solid = 0, noise = 0;
};
constexpr std::array kWeights = {
    Weights{1, 0, 0, 0},       Weights{1, .72, 0, .3},   Weights{2, .72, .65, 0},
    Weights{2, 0, 0, .5},      Weights{5, .72, 0, 0},    Weights{2, .72, .7, .3},
    Weights{2, 0, 0, .2},      Weights{3, .72, .7, .3},  Weights{1, .72, .65, .5},
    Weights{.5, .72, .75, .3}, Weights{20, .72, .6, .1}, Weights{1, .5, .6, .3}};
constexpr double kFewMerges = 4;        // that are worth half of the work
constexpr double kShareOfRounds = 0.7;  // of what the work allows
constexpr double kNoiseOfRepairs = 0.3, kMergesOfARound = 0.3;
constexpr int kFirstSeedOfRepairs = 300;
constexpr double kFittingFill = 0.72;  // see MergeSettings::least_fill
constexpr double kLargeRegion = 0.1;   // that is worth bisecting
const CostRules kUsual{.chart = 0.8, .small_chart = 0.4, .wanted_fill = 0.69};
const CostRules kAcross{.chart = 0.5, .small_chart = 0.2, .wanted_fill = 0.68};  // to bisect for
constexpr double kFacesOfAMerge = 20, kMergesOfFinishing = 1;  // for each face; in merges
constexpr std::size_t kAbreast = 4, kRoundsOfAStep = 4;        // merges at once; see widen()
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double all_of(const Candidate& own) { return own.cost.all; }

}  // namespace

MergeSearch::MergeSearch(const MergeContext& context, const Partition& from,
                         const MergeSettings& settings, const SearchPlan& plan, Executor& executor)
    : context_(context),
      from_(from),
      settings_(settings),
      executor_(executor),
      joiner_(context.surface),
      extent_(plan.extent) {
  const double searches =
      extent_.faces / (context_.surface.face_count() * std::max(1.0, settings_.page_area));
  const double wanted = std::max(std::min(searches / 2, kFewMerges), searches / 4);
  merges_ = static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(extent_.merges)));
  rounds_ = static_cast<std::size_t>(std::clamp(kShareOfRounds * searches, 0.0, extent_.rounds));
  kept_ = std::clamp(merges_ / 2, std::size_t{1}, extent_.kept);
  const auto of_rounds = [&](std::size_t rounds) {
    return (kMergesOfARound * static_cast<double>(rounds) + kMergesOfFinishing) *
           static_cast<double>(kept_);
  };
  work_left_ = static_cast<double>(merges_) + of_rounds(rounds_) +
               static_cast<double>(plan.steps) * (of_rounds(std::min(rounds_, kRoundsOfAStep)) +
                                                  static_cast<double>(std::min(kAbreast, merges_)));
  merge_faces_ = kFacesOfAMerge * context_.surface.face_count();
}

std::vector<Candidate> MergeSearch::merge_greedily() {
  std::vector<Candidate> best;
  for (std::size_t first = 0; first < merges_; first += kAbreast) {
    merge_some(first, std::min(kAbreast, merges_ - first), best);
    if (all_of(best.front()) <= 0) break;  // it needs no cut
  }
  return best;
}

void MergeSearch::merge_some(std::size_t first, std::size_t count, std::vector<Candidate>& best) {
  const double limit = best.size() < kept_ ? kInfinity : best.back().cost.all;
  begin(static_cast<double>(count));
  std::vector<Candidate> found = solve::parallel_map<Candidate>(
      count, executor_,
      [&](std::size_t k) { return price(merge(from_, settings_of(first + k)), limit, kUsual); });
  learn(found);
  merge_faces_ = context_.progress->done() / static_cast<double>(count);
  for (Candidate& own : found) best.push_back(std::move(own));
  std::ranges::stable_sort(best, std::less(), all_of);
  const auto cost_alike = [](const Candidate& x, const Candidate& y) {
    return all_of(x) == all_of(y);
  };
  best.erase(std::unique(best.begin(), best.end(), cost_alike), best.end());
  best.resize(std::min(best.size(), kept_));
}

void MergeSearch::search_neighbourhoods(std::vector<Candidate>& best) {
  const auto count = static_cast<double>(best.size());
  double idle = 0;  // rounds without a gain
  for (const std::size_t end = rounds_done_ + rounds_; rounds_done_ < end; ++rounds_done_, ++idle) {
    const auto regions = static_cast<double>(best.front().partition.regions.size());
    if (idle > extent_.idle * regions) break;
    begin(kMergesOfARound * count);
    std::vector<Candidate> found = solve::parallel_map<Candidate>(
        best.size(), executor_, [&](std::size_t k) { return remerge_part(best[k], rounds_done_); });
    learn(found);
    for (std::size_t k = 0; k < found.size(); ++k)
      if (all_of(found[k]) < all_of(best[k])) best[k] = std::move(found[k]), idle = 0;
  }
}

std::vector<Candidate> MergeSearch::shorten_borders(std::vector<Candidate> all) {
  begin(kMergesOfFinishing * static_cast<double>(all.size()));
  all = solve::parallel_map<Candidate>(all.size(), executor_, [&](std::size_t k) {
    return track([&](const MergeContext& context) {
      shorten_seams(context, settings_, all[k].partition);
      return std::move(all[k].partition);
    });
  });
  learn(all);
  return all;
}

std::vector<Candidate> MergeSearch::merge_again(std::vector<Candidate> all) {
  constexpr std::array kLeastFills = {0.0, kFittingFill};
  std::vector<Candidate> found = solve::parallel_map<Candidate>(
      all.size() * kLeastFills.size(), executor_, [&](std::size_t k) {
        return merge_more(all[k / kLeastFills.size()].partition,
                          kLeastFills[k % kLeastFills.size()]);
      });
  learn(found);
  for (Candidate& own : found) all.push_back(std::move(own));
  return all;
}

std::vector<Candidate> MergeSearch::close_and_attach(std::vector<Candidate> all) {
  all = distinct(std::move(all));
  all = solve::parallel_map<Candidate>(all.size(), executor_, [&](std::size_t k) {
    return track([&](const MergeContext& context) {
      close_slits(context, settings_, all[k].partition);
      attach_small_charts(context, settings_, all[k].partition);
      return std::move(all[k].partition);
    });
  });
  learn(all);
  return all;
}

Candidate MergeSearch::cheapest(std::vector<Candidate> all) const {
  all = distinct(std::move(all));
  Candidate best;
  for (Candidate& own : all) {
    own = price(std::move(own), best.cost.all, kUsual);
    if (own.cost.all < best.cost.all || best.partition.regions.empty()) best = std::move(own);
  }
  return best;
}

Candidate MergeSearch::price(Candidate own) const {
  return price(std::move(own), kInfinity, kUsual);
}

void MergeSearch::widen(double budget, std::vector<Candidate>& best) {
  settings_.cap *= budget / settings_.budget;
  settings_.budget = budget;
  rounds_ = std::min(rounds_, kRoundsOfAStep);
  const std::size_t count = std::min(kAbreast, merges_);
  merge_some(next_merge_, count, best);
  next_merge_ = (next_merge_ + count) % kWeights.size();
  search_neighbourhoods(best);
}

/// Begins a part of the work that takes as long as so many greedy merges.
void MergeSearch::begin(double merges) {
  context_.progress->begin(merges / work_left_, merges * merge_faces_);
  work_left_ = std::max(work_left_ - merges, merges);
}

MergeSettings MergeSearch::settings_of(std::size_t number) const {
  MergeSettings settings = settings_;
  const Weights& by = kWeights[number % kWeights.size()];
  settings.distortion_weight = by.distortion;
  settings.least_fill = by.least_fill;
  settings.least_solid = by.least_solid;
  settings.noise = by.noise;
  settings.seed = static_cast<int>(number);
  return settings;
}

/// Reports and remembers the tests of searches that ran side by side.
void MergeSearch::learn(std::vector<Candidate>& found) {
  double faces = 0;
  for (Candidate& own : found) {
    faces += own.tried_faces;
    failures_.take(std::move(own.failures));
    own.failures = {};
  }
  context_.progress->add(static_cast<std::size_t>(faces));
  throw_if_cancelled(context_.stop);
}

/// search(context) makes the partition; its failures and its tested faces are kept with it.
template <class Search>
Candidate MergeSearch::track(Search search) const {
  Candidate found;
  ProgressEstimate own({});
  found.failures = FailedTrials(&failures_);
  found.partition = search(MergeContext{context_.surface, &own, &found.failures, context_.stop});
  found.tried_faces = own.done();
  return found;
}

Candidate MergeSearch::merge(Partition partition, const MergeSettings& settings) const {
  return track([&](const MergeContext& context) {
    SerialExecutor serial;
    return merge_regions(context, joiner_, std::move(partition), settings, serial);
  });
}

/// The partition after more unions, with its borders shortened again.
Candidate MergeSearch::merge_more(const Partition& partition, double least_fill) const {
  if (partition.regions.size() == 1) return {};
  MergeSettings settings = settings_;
  settings.least_fill = least_fill;
  return track([&](const MergeContext& context) {
    SerialExecutor serial;
    Partition next = merge_regions(context, joiner_, partition, settings, serial);
    shorten_seams(context, settings, next);
    return next;
  });
}

/// One round of large-neighbourhood search. The cost is known where it is lower than that of
/// `best`.
Candidate MergeSearch::remerge_part(const Candidate& best, std::size_t number) const {
  if (best.partition.regions.size() <= 1) return {};
  MergeSettings settings = settings_of(number);
  settings.seed = kFirstSeedOfRepairs + static_cast<int>(number);
  settings.noise = kNoiseOfRepairs;
  Destroyed loose = destroy(context_.surface, from_, best.partition, number);
  settings.whole = loose.whole;
  Candidate again = merge(std::move(loose.partition), settings);
  return price(std::move(again), best.cost.all, kUsual);
}

/// With region k in two parts; nothing where it is too small for that, or a part has no sound map.
Candidate MergeSearch::parted(const Candidate& whole, std::size_t k, std::size_t way) const {
  if (whole.partition.regions[k].area < kLargeRegion) return {};
  return track([&](const MergeContext& context) {
    std::optional<Partition> cut = bisect(context, settings_, whole.partition, k, way);
    if (!cut) return Partition{};
    shorten_between(context, settings_, k, cut->regions.size() - 1, *cut);
    return std::move(*cut);
  });
}

Candidate MergeSearch::price_parted(Candidate own, double limit) const {
  return price(std::move(own), limit, kAcross);
}

/// Each distinct candidate once, the shortest seams first.
std::vector<Candidate> MergeSearch::distinct(std::vector<Candidate> all) const {
  std::erase_if(all, [](const Candidate& own) { return own.partition.regions.empty(); });
  for (Candidate& own : all) own = price(std::move(own), 0, kUsual);
  const auto seams = [](const Candidate& own) { return own.cost.seams; };
  std::ranges::stable_sort(all, std::less(), seams);
  const auto is_same = [&](const Candidate& a, const Candidate& b) { return seams(a) == seams(b); };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  return all;
}

/// The candidate with its cost, if that is below the limit.
Candidate MergeSearch::price(Candidate own, double limit, CostRules rules) const {
  rules.page_area = settings_.page_area;
  rules.limit = limit;
  rules.longest = longest_;
  rules.packing = extent_.packing;
  rules.stop = context_.stop;
  own.cost = partition_cost(context_.surface, own.partition, rules);
  return own;
}

}  // namespace unwrapd::segment::search
