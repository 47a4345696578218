// One greedy merge is a matter of luck: what distortion costs beside border decides which unions
// come first, and no price is best for all shapes. So several are tried. What is left then is
// judged as a user would: by its seams, its number of charts, and by a rough packing, since few
// wide charts that lie like stars or rings leave the page empty. Some of the tries refuse such
// charts from the start. Rejected: roundness as part of the price of a union: small charts on the
// way are seldom round, and what counts is the fill of the page, which large charts decide.
#include "core/atlas/best_merge.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "core/atlas/glue_slits.hpp"
#include "core/atlas/halve.hpp"
#include "core/atlas/labels.hpp"
#include "core/atlas/loosen.hpp"
#include "core/atlas/pack.hpp"
#include "core/atlas/straighten.hpp"

namespace unwrapd {
namespace {

/// What of MergeRules differs between the tries.
struct Try {
  double price = 0, least_fill = 0, least_solid = 0, whim = 0;
};
constexpr std::array kTries = {Try{1, 0, 0, 0},       Try{1, .72, 0, .3},   Try{2, .72, .65, 0},
                               Try{2, 0, 0, .5},      Try{5, .72, 0, 0},    Try{2, .72, .7, .3},
                               Try{2, 0, 0, .2},      Try{3, .72, .7, .3},  Try{1, .72, .65, .5},
                               Try{.5, .72, .75, .3}, Try{20, .72, .6, .1}, Try{1, .5, .6, .3}};
constexpr double kFacesOfSearch = 100'000;  // that are merged for a page, about
constexpr std::size_t kFinished = 2;        // of the tries: mended, and with borders drawn straight
constexpr double kFewTries = 4;             // that are worth half of all the merging
constexpr double kShareOfMends = 0.7, kMostMends = 20;  // of how often all could be merged anew
constexpr double kWhimOfMends = 0.3, kTriesOfAMend = 0.3;
constexpr int kFirstLotOfMends = 100;
constexpr double kFittingFill = 0.72;  // see MergeRules::least_fill
constexpr double kCostOfAChart = 0.15;
constexpr double kWantedFill = 0.7, kCostOfEmptiness = 14;  // for a page that is empty beyond that
constexpr double kLargeRegion = 0.1, kEnoughFill = 0.645;  // that is worth cutting across; for what
constexpr double kFacesOfATry = 20, kTriesOfFinishing = 1;  // for each face; see Effort
constexpr double kMostPage = 1.5;  // of the sheet: with more beside it, others fill the gaps

std::vector<Outline> outlines(const Sheet& sheet, const Partition& partition,
                              const std::vector<Index>& owner) {
  std::vector<Outline> all(partition.patches.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Region& region = partition.patches[k].region;
    for (std::size_t f = 0; f < region.faces.size(); ++f)
      for (Index i = 0; i < 3; ++i) {
        const Index h = 3 * region.faces[f] + i, twin = sheet.halfedges.twin[h];
        const CornerUv& uv = region.uv[f];
        if (twin == kNoTwin || partition.open[h] != 0 ||
            owner[face_of(twin)] != static_cast<Index>(k))
          all[k].push_back({uv[i], uv[(i + 1) % 3]});
      }
  }
  return all;
}

double seam_of(const Sheet& sheet, const Partition& partition, const std::vector<Index>& owner) {
  double seam = 0;
  for (std::size_t h = 0; h < partition.open.size(); ++h) {
    const Index twin = sheet.halfedges.twin[h];
    if (twin == kNoTwin) continue;
    if (partition.open[h] != 0 || owner[face_of(twin)] != owner[h / 3]) seam += sheet.length[h] / 2;
  }
  return seam;
}

/// What a partition costs: its seams (the sheet's area is 1), and something for each chart and for
/// the page that it leaves empty.
double cost_of(const Sheet& sheet, const Partition& partition, const MergeRules& rules,
               double wanted_fill = kWantedFill) {
  const std::vector<Index> owner = owners(sheet, partition);
  const double seam = seam_of(sheet, partition, owner);
  if (seam <= 0) return 0;  // what needs no cut is left whole
  double cost = seam + kCostOfAChart * static_cast<double>(partition.patches.size());
  const bool has_page = rules.page_area <= kMostPage;
  const double fill =
      has_page ? rough_fill(outlines(sheet, partition, owner), rules.stop) : wanted_fill;
  cost += kCostOfEmptiness * std::max(0.0, wanted_fill - fill);
  return rounded(cost);
}

/// A partition and its cost_of().
struct Candidate {
  double cost = 0;
  Partition partition;
};

class Search {
 public:
  Search(const Sheet& sheet, const MergeRules& rules, Executor& executor)
      : sheet_(sheet), rules_(rules), executor_(executor), joiner_(sheet) {
    const double rounds = kFacesOfSearch / (sheet_.face_count() * std::max(1.0, rules_.page_area));
    const double wanted = std::max(std::min(rounds / 2, kFewTries), rounds / 4);
    tries_ = static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(kTries.size())));
    mends_ = static_cast<int>(std::clamp(kShareOfMends * rounds, 0.0, kMostMends));
    kept_ = std::clamp(tries_ / 2, std::size_t{1}, kFinished);
    weight_left_ = static_cast<double>(tries_) +
                   (kTriesOfAMend * mends_ + kTriesOfFinishing) * static_cast<double>(kept_);
    try_faces_ = kFacesOfATry * sheet_.face_count();
  }

  /// The cheapest of the tries, the best first.
  std::vector<Candidate> greedy(const Partition& from) {
    std::vector<Candidate> best;
    for (std::size_t k = 0; k < tries_; ++k) {
      begin(1);
      add(merge_patches(joiner_, sheet_, from, rules_of(k), executor_), best);
      try_faces_ = rules_.effort->done();
      std::ranges::stable_sort(best, std::less(), &Candidate::cost);
      if (best.size() > kept_) best.pop_back();
    }
    return best;
  }

  /// Again and again a part is taken apart and merged anew; what is cheaper stays (large
  /// neighbourhood search, Shaw 1998).
  [[nodiscard]] Candidate mended(const Partition& from, Candidate best) {
    for (int k = 0; k < mends_ && best.partition.patches.size() > 1; ++k) {
      begin(kTriesOfAMend);
      MergeRules rules = rules_of(static_cast<std::size_t>(k) % kTries.size());
      rules.lot = kFirstLotOfMends + k;
      rules.whim = kWhimOfMends;
      Loosened loose = loosened(sheet_, from, best.partition, static_cast<std::uint64_t>(k));
      rules.whole = loose.whole;
      Partition again =
          merge_patches(joiner_, sheet_, std::move(loose.partition), rules, executor_);
      const double cost = cost_of(sheet_, again, rules_);
      if (cost < best.cost) best = {cost, std::move(again)};
    }
    return best;
  }

  /// With borders drawn straight; and with what then fits together merged, of any shape or not.
  std::vector<Candidate> finished(Partition partition) {
    begin(kTriesOfFinishing);
    std::vector<Candidate> all;
    if (partition.patches.size() == 1) {
      add(std::move(partition), all);
      return all;
    }
    straighten(sheet_, rules_, partition);
    for (const double least_fill : {0.0, kFittingFill}) {
      MergeRules rules = rules_;
      rules.least_fill = least_fill;
      Partition merged = merge_patches(joiner_, sheet_, partition, rules, executor_);
      straighten(sheet_, rules, merged);
      add(std::move(merged), all);
    }
    add(std::move(partition), all);
    return all;
  }

  /// The region is cut across whose halves make the partition cheapest, again and again as long as
  /// that helps: few charts that merged into rings and stars leave a page emptier than it need be.
  [[nodiscard]] Partition taken_apart(Partition partition) const {
    Candidate best{cost_of(sheet_, partition, rules_, kEnoughFill), std::move(partition)};
    while (true) {
      const Candidate from = best;
      for (std::size_t k = 0; k < from.partition.patches.size(); ++k) {
        if (from.partition.patches[k].area < kLargeRegion) continue;
        std::optional<Partition> apart = halved(sheet_, from.partition, k, rules_);
        if (!apart) continue;
        straighten(sheet_, rules_, *apart);
        const double cost = cost_of(sheet_, *apart, rules_, kEnoughFill);
        if (cost < best.cost) best = {cost, std::move(*apart)};
      }
      if (best.cost >= from.cost) return std::move(best.partition);
    }
  }

 private:
  /// A part of the work begins that takes as long as so many tries, of which the last one tells.
  void begin(double tries) {
    rules_.effort->begin(tries / weight_left_, tries * try_faces_);
    weight_left_ = std::max(weight_left_ - tries, tries);
  }

  [[nodiscard]] MergeRules rules_of(std::size_t number) const {
    MergeRules rules = rules_;
    rules.price = kTries[number].price;
    rules.least_fill = kTries[number].least_fill;
    rules.least_solid = kTries[number].least_solid;
    rules.whim = kTries[number].whim;
    rules.lot = static_cast<int>(number);
    return rules;
  }

  void add(Partition partition, std::vector<Candidate>& to) const {
    const double cost = cost_of(sheet_, partition, rules_);
    to.push_back({cost, std::move(partition)});
  }

  const Sheet& sheet_;
  const MergeRules& rules_;
  Executor& executor_;
  Joiner joiner_;
  std::size_t tries_ = 1, kept_ = 1;
  int mends_ = 0;           ///< of each that is kept
  double weight_left_ = 1;  ///< of the work, in tries
  double try_faces_ = 0;    ///< that the last try took, or the first is thought to take
};

}  // namespace

Partition best_merge(const Sheet& sheet, const Partition& from, const MergeRules& rules,
                     Executor& executor) {
  Search search(sheet, rules, executor);
  Candidate best{std::numeric_limits<double>::infinity(), {}};
  for (Candidate& greedy : search.greedy(from)) {
    Candidate mended = search.mended(from, std::move(greedy));
    for (Candidate& own : search.finished(std::move(mended.partition)))
      if (own.cost < best.cost) best = std::move(own);
  }
  best.partition = search.taken_apart(std::move(best.partition));
  glue_slits(sheet, rules, best.partition);
  return std::move(best.partition);
}

}  // namespace unwrapd
