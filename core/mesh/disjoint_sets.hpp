#pragma once
// Which of n things belong together, as they are joined one pair after another: a forest with a
// root for each set (Galler and Fischer, 1964), its paths halved while they are walked (van Leeuwen
// and Tarjan, 1984). No ranks: the root that is named second stays, which the callers' order rests
// on.

#include <cstddef>
#include <numeric>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

class DisjointSets {
 public:
  /// n sets of one thing each.
  explicit DisjointSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// The thing that stands for the set of k, in [0, n).
  Index root(Index k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }

  /// Puts the set of `from` to that of `to`, whose root stays.
  /// \return whether they were two.
  bool join(Index from, Index to) {
    const Index a = root(from), b = root(to);
    parent_[a] = b;
    return a != b;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace unwrapd
