#pragma once
// A union-find structure whose elements have one of two orientations relative to their root.

#include <utility>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// Sets of elements whose orientations relative to each other are known.
class ParitySets {
 public:
  /// count sets of one element each.
  explicit ParitySets(std::size_t count) : parent_(count), turned_(count, 0) {
    for (std::size_t k = 0; k < count; ++k) parent_[k] = static_cast<Index>(k);
  }

  /// Gives a and b opposite orientations, or the same. \return false if they are already known to
  /// have others.
  bool relate(Index a, Index b, bool are_opposite) {
    const auto [root_a, turned_a] = find(a);
    const auto [root_b, turned_b] = find(b);
    if (root_a == root_b) return (turned_a != turned_b) == are_opposite;
    parent_[root_a] = root_b;
    turned_[root_a] = (turned_a != turned_b) != are_opposite ? 1 : 0;
    return true;
  }

  /// The root of an element, and whether the two have opposite orientations.
  std::pair<Index, bool> find(Index k) {
    bool turned = false;
    while (parent_[k] != k) {
      const Index up = parent_[k];  // halve the path: point at the grandparent
      turned_[k] ^= turned_[up];    // a root is not reversed
      parent_[k] = parent_[up];
      turned = turned != (turned_[k] != 0);
      k = parent_[k];
    }
    return {k, turned};
  }

 private:
  std::vector<Index> parent_;
  std::vector<char> turned_;  // relative to the parent
};

}  // namespace unwrapd
