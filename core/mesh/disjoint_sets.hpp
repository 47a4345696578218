#pragma once
// A union-find structure over n elements: a forest with a root for each set (Galler and Fischer,
// 1964) and path halving (van Leeuwen and Tarjan, 1984). There are no ranks: the root of the second
// argument stays, which callers rely on.

#include <cstddef>
#include <numeric>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

class DisjointSets {
 public:
  /// n sets of one element each.
  explicit DisjointSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// The root of the set of k, in [0, n).
  Index root(Index k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }

  /// Joins the set of `from` to that of `to`, whose root stays. \return whether they were two sets.
  bool join(Index from, Index to) {
    const Index a = root(from), b = root(to);
    parent_[a] = b;
    return a != b;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace unwrapd
