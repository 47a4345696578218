#pragma once
// Subtrees of the elimination tree that threads process in parallel.

#include <vector>

#include "core/linear/supernodal.hpp"

namespace unwrapd::linear {

/// The supernodes first .. end-1: a whole subtree, whose root is the last.
struct Branch {
  std::size_t first, end;

  [[nodiscard]] std::size_t root() const { return end - 1; }
};

/// Branches are disjoint, ascending, and independent of the number of threads. All other supernodes
/// are the trunk: the tree above the branches, and subtrees too small for a task.
struct Branches {
  std::vector<Branch> all;
  /// The number of each column among those above some branch; kOwnColumn for all others.
  std::vector<Index> shared;
  std::size_t shared_count = 0;

  /// Calls visit(s) for the supernodes of the trunk, in ascending order, and enter(b) where branch
  /// b lies between them.
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

/// weight: the work of each supernode.
Branches branches_of(const Supernodes& nodes, const std::vector<std::size_t>& weight);

}  // namespace unwrapd::linear
