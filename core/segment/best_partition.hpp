#pragma once
// The best of several ways to merge the patches of a surface.

#include <vector>

#include "core/segment/merge_search.hpp"

namespace unwrapd::segment {

/// Merges greedily at several prices, with and without an eye on the page, and takes what is best
/// by seam, number of charts and how well they fill a page; its borders are then straightened, and
/// what fits together after that is merged. The same for any executor. All throw Error{cancelled}.
class BestPartition {
 public:
  /// rules: distortion_weight and least_fill are chosen here. steps: how often loosen() is going to
  /// be called. surface, from and executor must outlive this.
  BestPartition(const SegmentationMesh& surface, const Partition& from, const MergeRules& rules,
                std::size_t steps, Executor& executor);

  /// The best for the budget of the rules. It comes first, once.
  const Partition& first();

  /// Goes on for a budget that is larger than the last one. Returns whether the best partition
  /// was replaced: by one that has shorter seams and costs less.
  bool loosen(double budget);

  [[nodiscard]] const Partition& best() const { return best_.partition; }

 private:
  MergeSearch search_;
  std::vector<Candidate> mended_;
  Candidate best_;
  bool is_priced_ = false;
};

}  // namespace unwrapd::segment
