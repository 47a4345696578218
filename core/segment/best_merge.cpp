// A looser bound starts from what the tighter one came to and takes nothing but shorter seams, step
// by step, so that no bound ever costs more seam than a tighter one. Rejected: a search of its own
// for every bound: of twelve made surfaces one pair of bounds in twelve had longer seams at the
// looser one, by up to a third.
#include "core/segment/best_merge.hpp"

#include <utility>
#include <vector>

#include "core/segment/merge_search.hpp"

namespace unwrapd {

Partition best_merge(const Sheet& sheet, const Partition& from, const MergeRules& rules,
                     std::span<const double> looser, Executor& executor) {
  MergeSearch search(sheet, from, rules, looser.size(), executor);
  std::vector<Candidate> mended = search.greedy();
  search.mend(mended);
  Candidate best = search.taken_apart(search.finished(mended));
  if (!looser.empty()) best = search.priced(std::move(best));
  for (const double budget : looser) {
    if (best.cost.seam <= 0) break;  // it needs no cut
    search.widen(budget, mended);
    best = search.with_shorter_seams(mended, std::move(best));
  }
  return std::move(best.partition);
}

}  // namespace unwrapd
