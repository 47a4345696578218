#pragma once
// The steps of the search for the best way to merge the regions of a surface, in the order of their
// use by SurfaceSegmentation.

#include <limits>
#include <vector>

#include "core/segment/base/failed_trials.hpp"
#include "core/segment/base/search_extent.hpp"
#include "core/segment/search/partition_cost.hpp"

namespace unwrapd::segment::search {

/// A partition that competes with others.
struct Candidate {
  Partition partition = {};
  PartitionCost cost = {};
  double tried_faces = 0;      ///< faces tested on the way to it; see ProgressEstimate
  FailedTrials failures = {};  ///< on the way to it
};

/// How long a search is going to be.
struct SearchPlan {
  SearchExtent extent = {};
  std::size_t steps = 0;  ///< how often widen() is going to be called
};

/// Every step is the same for any executor and throws Error{cancelled}.
class MergeSearch {
 public:
  /// What context and from refer to, and executor,
  /// must outlive this; the context needs a progress estimate.
  MergeSearch(const MergeContext& context, const Partition& from, const MergeSettings& settings,
              const SearchPlan& plan, Executor& executor);

  /// Greedy merges under several settings: the cheapest of the results, ascending.
  std::vector<Candidate> merge_greedily();

  /// Large-neighbourhood search (Shaw 1998): a part of each candidate is destroyed and merged
  /// again, many times; what is cheaper stays.
  void search_neighbourhoods(std::vector<Candidate>& best);

  /// Shortens the borders of all. From here on borders may run through regions that merging
  /// started from, so that search_neighbourhoods() can no longer be used.
  std::vector<Candidate> shorten_borders(std::vector<Candidate> all);

  /// Adds to each what it comes to when the unions are merged that its short borders allow: of any
  /// shape, and of shapes that fill a page well.
  std::vector<Candidate> merge_again(std::vector<Candidate> all);

  /// Each distinct candidate with its slits closed and its small charts attached.
  std::vector<Candidate> close_and_attach(std::vector<Candidate> all);

  /// The cheapest candidate, with its cost.
  [[nodiscard]] Candidate cheapest(std::vector<Candidate> all) const;

  /// Cuts a region in two where that makes the partition cheapest, as long as it helps: rings and
  /// stars leave a page emptier than necessary. Then closes slits that are no longer needed. The
  /// cost is not that of the result: see price(). most: regions that cuts may lead to.
  [[nodiscard]] Candidate bisect_regions(Candidate whole, Index most);

  /// The candidate with its cost, which takes a rough packing.
  [[nodiscard]] Candidate price(Candidate own) const;

  /// Raises the budget. More greedy merges compete with `best`, which the search so far has led to,
  /// and the cheapest go through search_neighbourhoods().
  void widen(double budget, std::vector<Candidate>& best);

  /// Candidates with seams of this length or more cost infinitely much from here on.
  void forbid_seams_from(double length) { longest_ = length; }

 private:
  void begin(double merges);
  void merge_some(std::size_t first, std::size_t count, std::vector<Candidate>& best);
  [[nodiscard]] MergeSettings settings_of(std::size_t number) const;
  void learn(std::vector<Candidate>& found);
  template <class Search>
  [[nodiscard]] Candidate track(Search search) const;
  [[nodiscard]] Candidate merge(Partition partition, const MergeSettings& settings) const;
  [[nodiscard]] Candidate merge_more(const Partition& partition, double least_fill) const;
  [[nodiscard]] Candidate remerge_part(const Candidate& best, std::size_t number) const;
  /// Whether bisecting goes on though it gains nothing yet.
  static bool is_far_from_full(const PartitionCost& cost);
  [[nodiscard]] Candidate price_parted(Candidate own, double limit) const;
  [[nodiscard]] Candidate parted(const Candidate& whole, std::size_t k, std::size_t way) const;
  std::vector<Candidate> all_parted(const Candidate& whole);
  [[nodiscard]] std::vector<Candidate> distinct(std::vector<Candidate> all) const;
  [[nodiscard]] Candidate price(Candidate own, double limit, CostRules rules) const;

  const MergeContext context_;
  const Partition& from_;
  MergeSettings settings_;
  Executor& executor_;
  Joiner joiner_;
  FailedTrials failures_;  ///< of all searches that have ended
  SearchExtent extent_;
  std::size_t merges_ = 1, kept_ = 1;
  std::size_t rounds_ = 0;  ///< of search_neighbourhoods()
  std::size_t rounds_done_ = 0;
  std::size_t next_merge_ = 0;                                ///< of those that widen() makes
  double longest_ = std::numeric_limits<double>::infinity();  ///< see forbid_seams_from()
  double work_left_ = 1;                                      ///< in greedy merges
  double merge_faces_ = 0;  ///< faces that a greedy merge tests: a guess until the first is done
};

}  // namespace unwrapd::segment::search
