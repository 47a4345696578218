// A subtree is a branch if it has at most a twelfth of the work and its parent's subtree has more.
// The bounds do not depend on the number of threads, and sums of branches stay separate until all
// are done, so that any number of threads gives the same bits. Rejected: a branch for each thread,
// which leaves threads idle if the tree is uneven; dynamic tasks for all supernodes, whose sums
// would need an order.
#include "core/linear/branches.hpp"

#include <numeric>

#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {

constexpr std::size_t kMostOfWork = 12;    // a branch has at most this fraction of the work
constexpr std::size_t kLeastOfWork = 512;  // and at least this one
constexpr std::size_t kWorthTasks = std::size_t{1}
                                    << 18;  // weight below which there are no branches

constexpr std::size_t kNone = ~std::size_t{0};

struct Subtrees {
  std::vector<std::size_t> parent, first, weight;  ///< of the subtree under each supernode
};

Subtrees subtrees_of(const Supernodes& nodes, const std::vector<std::size_t>& weight) {
  const std::size_t count = nodes.count();
  Subtrees trees{std::vector<std::size_t>(count, kNone), std::vector<std::size_t>(count), weight};
  std::vector<std::size_t> pending;
  for (std::size_t s = 0; s < count; ++s) {
    trees.first[s] = s;
    for (Index c = 0; c < nodes.child_count[s]; ++c) {
      const std::size_t child = pending.back();
      pending.pop_back();
      trees.parent[child] = s;
      trees.first[s] = trees.first[child];
      trees.weight[s] += trees.weight[child];
    }
    pending.push_back(s);
  }
  return trees;
}

}  // namespace

Branches branches_of(const Supernodes& nodes, const std::vector<std::size_t>& weight) {
  Branches branches;
  branches.shared.assign(nodes.order.size(), kOwnColumn);
  const std::size_t total = std::accumulate(weight.begin(), weight.end(), std::size_t{0});
  if (total < kWorthTasks) return branches;
  const Subtrees trees = subtrees_of(nodes, weight);
  const std::size_t most = total / kMostOfWork, least = total / kLeastOfWork;
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    const bool is_cut = trees.parent[s] == kNone || trees.weight[trees.parent[s]] > most;
    if (trees.weight[s] < least || trees.weight[s] > most || !is_cut) continue;
    branches.all.push_back({trees.first[s], s + 1});
    for (Index row : nodes.below(s))
      if (branches.shared[at(row)] == kOwnColumn)
        branches.shared[at(row)] = static_cast<Index>(branches.shared_count++);
  }
  return branches;
}

}  // namespace unwrapd::linear
