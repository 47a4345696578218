// One greedy merge is a matter of luck: what distortion costs beside border decides which unions
// come first, and no price is best for all shapes. So several are tried. What is left then is
// judged as a user would: by its seams, its number of charts, and by a rough packing, since few
// wide charts that lie like stars or rings leave the page empty. Some of the tries refuse such
// charts from the start. Rejected: roundness as part of the price of a union: small charts on the
// way are seldom round, and what counts is the fill of the page, which large charts decide.
#include "core/segment/merge_search.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/segment/attach_small_charts.hpp"
#include "core/segment/bisect.hpp"
#include "core/segment/close_slits.hpp"
#include "core/segment/destroy.hpp"
#include "core/segment/shorten_seams.hpp"
#include "core/solve/base/parallel_map.hpp"

namespace unwrapd::segment {
namespace {

/// What of MergeRules differs between the tries.
struct Try {
  double distortion_weight = 0, least_fill = 0, least_solid = 0, noise = 0;
};
constexpr std::array kTries = {Try{1, 0, 0, 0},       Try{1, .72, 0, .3},   Try{2, .72, .65, 0},
                               Try{2, 0, 0, .5},      Try{5, .72, 0, 0},    Try{2, .72, .7, .3},
                               Try{2, 0, 0, .2},      Try{3, .72, .7, .3},  Try{1, .72, .65, .5},
                               Try{.5, .72, .75, .3}, Try{20, .72, .6, .1}, Try{1, .5, .6, .3}};
constexpr double kFacesOfSearch = 100'000;  // that are merged for a page, about
constexpr std::size_t kFinished = 2;        // of the tries: mended, and with borders drawn straight
constexpr double kFewTries = 4;             // that are worth half of all the merging
constexpr double kShareOfMends = 0.7, kMostMends = 40;  // of how often all could be merged anew
constexpr double kWhimOfMends = 0.3, kTriesOfAMend = 0.3;
constexpr int kFirstLotOfMends = 300;
constexpr double kFittingFill = 0.72;  // see MergeRules::least_fill
constexpr double kLargeRegion = 0.1;   // that is worth cutting across
const CostRules kUsual{.chart = 0.8, .small_chart = 0.4, .wanted_fill = 0.68};
const CostRules kAcross{
    .chart = 0.3, .small_chart = 0.12, .wanted_fill = 0.665};  // to cut across for
constexpr double kFacesOfATry = 20, kTriesOfFinishing = 1;     // for each face; see Effort
constexpr std::size_t kAbreast = 4, kMendsOfAStep = 4;         // tries at once; see widen()
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double all_of(const Candidate& own) { return own.cost.all; }

}  // namespace

MergeSearch::MergeSearch(const SegmentationMesh& surface, const Partition& from,
                         const MergeRules& rules, std::size_t steps, Executor& executor)
    : surface_(surface), from_(from), rules_(rules), executor_(executor), joiner_(surface) {
  const double rounds = kFacesOfSearch / (surface_.face_count() * std::max(1.0, rules_.page_area));
  const double wanted = std::max(std::min(rounds / 2, kFewTries), rounds / 4);
  tries_ = static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(kTries.size())));
  mends_ = static_cast<std::size_t>(std::clamp(kShareOfMends * rounds, 0.0, kMostMends));
  kept_ = std::clamp(tries_ / 2, std::size_t{1}, kFinished);
  const auto of_mends = [&](std::size_t mends) {
    return (kTriesOfAMend * static_cast<double>(mends) + kTriesOfFinishing) *
           static_cast<double>(kept_);
  };
  weight_left_ = static_cast<double>(tries_) + of_mends(mends_) +
                 static_cast<double>(steps) * (of_mends(std::min(mends_, kMendsOfAStep)) +
                                               static_cast<double>(std::min(kAbreast, tries_)));
  try_faces_ = kFacesOfATry * surface_.face_count();
}

std::vector<Candidate> MergeSearch::greedy() {
  std::vector<Candidate> best;
  for (std::size_t first = 0; first < tries_; first += kAbreast) {
    try_some(first, std::min(kAbreast, tries_ - first), best);
    if (all_of(best.front()) <= 0) break;  // it needs no cut
  }
  return best;
}

void MergeSearch::try_some(std::size_t first, std::size_t count, std::vector<Candidate>& best) {
  const double limit = best.size() < kept_ ? kInfinity : best.back().cost.all;
  begin(static_cast<double>(count));
  std::vector<Candidate> found = solve::parallel_map<Candidate>(
      count, executor_,
      [&](std::size_t k) { return weighed(merged(from_, rules_of(first + k)), limit, kUsual); });
  learn(found);
  try_faces_ = rules_.progress->done() / static_cast<double>(count);
  for (Candidate& own : found) best.push_back(std::move(own));
  std::ranges::stable_sort(best, std::less(), all_of);
  const auto cost_alike = [](const Candidate& x, const Candidate& y) {
    return all_of(x) == all_of(y);
  };
  best.erase(std::unique(best.begin(), best.end(), cost_alike), best.end());
  best.resize(std::min(best.size(), kept_));
}

void MergeSearch::mend(std::vector<Candidate>& best) {
  const auto count = static_cast<double>(best.size());
  for (const std::size_t end = mended_ + mends_; mended_ < end; ++mended_) {
    begin(kTriesOfAMend * count);
    std::vector<Candidate> found = solve::parallel_map<Candidate>(
        best.size(), executor_, [&](std::size_t k) { return mended(best[k], mended_); });
    learn(found);
    for (std::size_t k = 0; k < found.size(); ++k)
      if (all_of(found[k]) < all_of(best[k])) best[k] = std::move(found[k]);
  }
}

Candidate MergeSearch::finished(std::vector<Candidate> all) {
  begin(kTriesOfFinishing * static_cast<double>(all.size()));
  all = solve::parallel_map<Candidate>(all.size(), executor_, [&](std::size_t k) {
    return with_shortened_seams(std::move(all[k].partition));
  });
  learn(all);
  constexpr std::array kLeastFills = {0.0, kFittingFill};
  std::vector<Candidate> found = solve::parallel_map<Candidate>(
      all.size() * kLeastFills.size(), executor_, [&](std::size_t k) {
        const Candidate& own = all[k / kLeastFills.size()];
        if (own.partition.patches.size() == 1) return Candidate{};
        MergeRules rules = rules_;
        rules.least_fill = kLeastFills[k % kLeastFills.size()];
        return noted(rules, [&](const MergeRules& by) {
          SerialExecutor serial;
          Partition next = merge_patches(joiner_, surface_, own.partition, by, serial);
          shorten_seams(surface_, by, next);
          return next;
        });
      });
  learn(found);
  for (Candidate& own : found) all.push_back(std::move(own));
  all = distinct(std::move(all));
  all = solve::parallel_map<Candidate>(
      all.size(), executor_, [&](std::size_t k) { return completed(std::move(all[k].partition)); });
  learn(all);
  return cheapest(std::move(all));
}

Candidate MergeSearch::taken_apart(Candidate whole) {
  Candidate best = weighed(std::move(whole), kInfinity, kAcross);
  while (best.cost.all > best.cost.seams) {
    std::vector<Candidate> found =
        solve::parallel_map<Candidate>(best.partition.patches.size(), executor_,
                                       [&](std::size_t k) { return cut_across(best, k); });
    learn(found);
    auto next = std::ranges::min_element(found, std::less(), all_of);
    if (!(next->cost.all < best.cost.all)) break;
    best = std::move(*next);
  }
  close_slits(surface_, rules_, best.partition);
  return best;
}

Candidate MergeSearch::priced(Candidate own) const {
  return weighed(std::move(own), kInfinity, kUsual);
}

void MergeSearch::widen(double budget, std::vector<Candidate>& best) {
  rules_.cap *= budget / rules_.budget;
  rules_.budget = budget;
  mends_ = std::min(mends_, kMendsOfAStep);
  const std::size_t count = std::min(kAbreast, tries_);
  try_some(next_try_, count, best);
  next_try_ = (next_try_ + count) % kTries.size();
  mend(best);
}

Candidate MergeSearch::with_shorter_seams(std::vector<Candidate> all, Candidate best) {
  longest_ = best.cost.seam;
  all.push_back(best);
  Candidate next = finished(std::move(all));
  if (next.cost.seam < longest_) {
    next = priced(taken_apart(std::move(next)));
    if (next.cost.all < best.cost.all) best = std::move(next);
  }
  longest_ = kInfinity;
  return best;
}

/// A part of the work begins that takes as long as so many tries, of which the last ones tell.
void MergeSearch::begin(double tries) {
  rules_.progress->begin(tries / weight_left_, tries * try_faces_);
  weight_left_ = std::max(weight_left_ - tries, tries);
}

MergeRules MergeSearch::rules_of(std::size_t number) const {
  MergeRules rules = rules_;
  const Try& by = kTries[number % kTries.size()];
  rules.distortion_weight = by.distortion_weight;
  rules.least_fill = by.least_fill;
  rules.least_solid = by.least_solid;
  rules.noise = by.noise;
  rules.seed = static_cast<int>(number);
  return rules;
}

/// What was tried on the way, told and remembered: searches side by side know nothing of each
/// other.
void MergeSearch::learn(std::vector<Candidate>& found) {
  double faces = 0;
  for (Candidate& own : found) {
    faces += own.tried_faces;
    failures_.take(std::move(own.failures));
    own.failures = {};
  }
  rules_.progress->add(static_cast<std::size_t>(faces));
  throw_if_cancelled(rules_.stop);
}

/// search(rules) makes the partition by them; its failures and faces are noted on the way.
template <class Work>
Candidate MergeSearch::noted(MergeRules rules, Work search) const {
  Candidate found;
  ProgressEstimate own({});
  found.failures = FailedTrials(&failures_);
  rules.progress = &own;
  rules.memory = &found.failures;
  found.partition = search(rules);
  found.tried_faces = own.done();
  return found;
}

Candidate MergeSearch::merged(Partition partition, const MergeRules& by) const {
  return noted(by, [&](const MergeRules& rules) {
    SerialExecutor serial;
    return merge_patches(joiner_, surface_, std::move(partition), rules, serial);
  });
}

/// Without a look at the page.
Candidate MergeSearch::with_shortened_seams(Partition partition) const {
  return noted(rules_, [&](const MergeRules& rules) {
    shorten_seams(surface_, rules, partition);
    return std::move(partition);
  });
}

/// With slits glued, and small regions hung on others.
Candidate MergeSearch::completed(Partition partition) const {
  return noted(rules_, [&](const MergeRules& rules) {
    close_slits(surface_, rules, partition);
    attach_small_charts(surface_, rules, partition);
    return std::move(partition);
  });
}

/// Some of `best` merged anew: its cost, where that is lower.
Candidate MergeSearch::mended(const Candidate& best, std::size_t number) const {
  if (best.partition.patches.size() <= 1) return {};
  MergeRules rules = rules_of(number);
  rules.seed = kFirstLotOfMends + static_cast<int>(number);
  rules.noise = kWhimOfMends;
  Destroyed loose = destroy(surface_, from_, best.partition, number);
  rules.whole = loose.whole;
  Candidate again = merged(std::move(loose.partition), rules);
  return weighed(std::move(again), best.cost.all, kUsual);
}

Candidate MergeSearch::cut_across(const Candidate& whole, std::size_t k) const {
  if (whole.partition.patches[k].area < kLargeRegion) return {};
  Candidate apart = noted(rules_, [&](const MergeRules& rules) {
    std::optional<Partition> cut = bisect(surface_, whole.partition, k, rules);
    if (!cut) return Partition{};
    shorten_seams(surface_, rules, *cut);
    return std::move(*cut);
  });
  if (apart.partition.patches.empty()) return apart;
  return weighed(std::move(apart), whole.cost.all, kAcross);
}

/// Each once, the least seams first.
std::vector<Candidate> MergeSearch::distinct(std::vector<Candidate> all) const {
  std::erase_if(all, [](const Candidate& own) { return own.partition.patches.empty(); });
  for (Candidate& own : all) own = weighed(std::move(own), 0, kUsual);
  const auto seams = [](const Candidate& own) { return own.cost.seams; };
  std::ranges::stable_sort(all, std::less(), seams);
  const auto repeats = std::ranges::unique(all, std::equal_to(), seams);
  all.erase(repeats.begin(), repeats.end());
  return all;
}

Candidate MergeSearch::cheapest(std::vector<Candidate> all) const {
  all = distinct(std::move(all));
  Candidate best;
  for (Candidate& own : all) {
    own = weighed(std::move(own), best.cost.all, kUsual);
    if (own.cost.all < best.cost.all || best.partition.patches.empty()) best = std::move(own);
  }
  return best;
}

/// With its cost, if that is below the limit.
Candidate MergeSearch::weighed(Candidate own, double limit, CostRules rules) const {
  rules.page_area = rules_.page_area;
  rules.limit = limit;
  rules.longest = longest_;
  rules.stop = rules_.stop;
  own.cost = partition_cost(surface_, own.partition, rules);
  return own;
}

}  // namespace unwrapd::segment
