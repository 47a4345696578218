#pragma once
// The best of several ways to merge the patches of a surface.

#include <span>

#include "core/segment/merge.hpp"

namespace unwrapd {

/// Merges greedily at several prices, with and without an eye on the page, and takes what is best
/// by seam, number of charts and how well they fill a page; its borders are then straightened, and
/// what fits together after that is merged. rules: price and least_fill are chosen here.
/// looser: further budgets, ascending and above that of the rules. The partition for each is that
/// of the one before, or has shorter seams and costs less; the last one's is returned.
/// The same for any executor. Throws Error{cancelled}.
Partition best_merge(const Sheet& sheet, const Partition& from, const MergeRules& rules,
                     std::span<const double> looser, Executor& executor);

}  // namespace unwrapd
