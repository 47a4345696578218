#pragma once
// The steps of the search for the best way to merge the patches of a surface.

#include <limits>
#include <optional>
#include <vector>

#include "core/segment/candidate.hpp"

namespace unwrapd::segment {

/// Partitions of one surface that compete. Every step is the same for any executor and throws
/// Error{cancelled}.
class MergeSearch {
 public:
  /// steps: how often widen() is going to be called. surface, from and executor must outlive this.
  MergeSearch(const SegmentationMesh& surface, const Partition& from, const MergeRules& rules,
              std::size_t steps, Executor& executor);

  /// The cheapest of the tries, the best first.
  std::vector<Candidate> greedy();

  /// Again and again a part of each is taken apart and merged anew; what is cheaper stays (large
  /// neighbourhood search, Shaw 1998).
  void mend(std::vector<Candidate>& best);

  /// The cheapest after borders were drawn straight; and after what then fits together was merged,
  /// of any shape or not. Its borders may run through patches: it cannot be mended.
  Candidate finished(std::vector<Candidate> all);

  /// The region is cut across whose halves make the partition cheapest, again and again as long as
  /// that helps: few charts that merged into rings and stars leave a page emptier than it need be.
  /// Slits that are not needed then are glued. The cost is not that of the result: see priced().
  [[nodiscard]] Candidate taken_apart(Candidate whole);

  /// With its cost, which takes a rough packing.
  [[nodiscard]] Candidate priced(Candidate own) const;

  /// From here on the excess of all may be as much as this budget, which is larger than before.
  /// best: what was mended so far; some more tries compete with it, and the cheapest are mended.
  void widen(double budget, std::vector<Candidate>& best);

  /// Of what all of them and `best` come to when they are finished and taken apart, the cheapest
  /// whose seams are shorter than those of `best`; that itself where none costs less.
  Candidate with_shorter_seams(std::vector<Candidate> all, Candidate best);

 private:
  void begin(double tries);
  void try_some(std::size_t first, std::size_t count, std::vector<Candidate>& best);
  [[nodiscard]] MergeRules rules_of(std::size_t number) const;
  void learn(std::vector<Candidate>& found);
  template <class Work>
  [[nodiscard]] Candidate noted(MergeRules rules, Work search) const;
  [[nodiscard]] Candidate merged(Partition partition, const MergeRules& by) const;
  [[nodiscard]] Candidate with_shortened_seams(Partition partition) const;
  [[nodiscard]] Candidate completed(Partition partition) const;
  [[nodiscard]] Candidate mended(const Candidate& best, std::size_t number) const;
  [[nodiscard]] Candidate cut_across(const Candidate& whole, std::size_t k) const;
  [[nodiscard]] std::vector<Candidate> distinct(std::vector<Candidate> all) const;
  [[nodiscard]] Candidate cheapest(std::vector<Candidate> all) const;
  [[nodiscard]] Candidate weighed(Candidate own, double limit, CostRules rules) const;

  const SegmentationMesh& surface_;
  const Partition& from_;
  MergeRules rules_;
  Executor& executor_;
  Joiner joiner_;
  FailedTrials failures_;  ///< of all searches that have ended
  std::size_t tries_ = 1, kept_ = 1;
  std::size_t mends_ = 0;     ///< of each that is kept
  std::size_t mended_ = 0;    ///< how often each was
  std::size_t next_try_ = 0;  ///< of those that widen() makes
  double longest_ =
      std::numeric_limits<double>::infinity();  ///< seams that a candidate may not have
  double weight_left_ = 1;                      ///< of the work, in tries
  double try_faces_ = 0;  ///< that a try took, or the first ones are thought to take
};

}  // namespace unwrapd::segment
