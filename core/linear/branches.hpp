#pragma once
// Subtrees of the elimination tree that threads work on at the same time.

#include <vector>

#include "core/linear/supernodal.hpp"

namespace unwrapd::linear {

/// The supernodes first .. end-1: a whole subtree, whose root is the last.
struct Branch {
  std::size_t first, end;

  [[nodiscard]] std::size_t root() const { return end - 1; }
};

/// Branches are disjoint, ascending, and the same whatever the number of threads. What is in none
/// is the trunk: the rest of the tree above them, and subtrees too small to be worth a task.
struct Branches {
  std::vector<Branch> all;
  /// Of each column: which of the columns it is that lie above some branch; kOwnColumn: of none.
  std::vector<Index> shared;
  std::size_t shared_count = 0;

  /// Calls visit(s) for the supernodes of the trunk, in ascending order, and enter(b) where branch
  /// b is passed.
  template <typename Visit, typename Enter>
  void for_each_of_trunk(std::size_t count, Visit visit, Enter enter) const {
    std::size_t s = 0;
    for (std::size_t b = 0; b <= all.size(); ++b) {
      for (const std::size_t end = b < all.size() ? all[b].first : count; s < end; ++s) visit(s);
      if (b == all.size()) break;
      enter(b);
      s = all[b].end;
    }
  }
};

inline constexpr Index kOwnColumn = -1;

/// weight: of each supernode, what work it is.
Branches branches_of(const Supernodes& nodes, const std::vector<std::size_t>& weight);

}  // namespace unwrapd::linear
