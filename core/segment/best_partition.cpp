// A looser bound starts from what the tighter one came to and takes nothing but shorter seams, step
// by step, so that no bound ever costs more seam than a tighter one. Rejected: a search of its own
// for every bound: of twelve made surfaces one pair of bounds in twelve had longer seams at the
// looser one, by up to a third.
#include "core/segment/best_partition.hpp"

#include <utility>

namespace unwrapd::segment {

BestPartition::BestPartition(const SegmentationMesh& surface, const Partition& from,
                             const MergeRules& rules, std::size_t steps, Executor& executor)
    : search_(surface, from, rules, steps, executor) {}

const Partition& BestPartition::first() {
  mended_ = search_.greedy();
  search_.mend(mended_);
  best_ = search_.taken_apart(search_.finished(mended_));
  return best_.partition;
}

bool BestPartition::loosen(double budget) {
  if (!std::exchange(is_priced_, true)) best_ = search_.priced(std::move(best_));
  const double seam = best_.cost.seam;
  if (seam <= 0) return false;  // it needs no cut
  search_.widen(budget, mended_);
  best_ = search_.with_shorter_seams(mended_, std::move(best_));
  return best_.cost.seam < seam;
}

}  // namespace unwrapd::segment
