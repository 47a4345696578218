#pragma once
// The stable linear-time sort behind every matching of equal keys: pairing half-edges, duplicate
// faces, copies of vertices. Hash maps would need a hash that nobody can attack, and are slower.

#include <stop_token>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// Sorts items by key(item) in [0, key_count); equal keys keep their order. Sorting by several keys
/// is sorting by the last of them first. Throws Error{cancelled}.
template <class Item, class Key>
void counting_sort(std::vector<Item>& items, Index key_count, Key key,
                   const std::stop_token& stop = {}) {
  std::vector<Index> place(static_cast<std::size_t>(key_count) + 1, 0);
  for (std::size_t k = 0; k < items.size(); ++k) {
    check_cancelled_every(k, stop);
    ++place[key(items[k]) + 1];
  }
  for (std::size_t k = 1; k < place.size(); ++k) place[k] += place[k - 1];
  std::vector<Item> sorted(items.size());
  for (std::size_t k = 0; k < items.size(); ++k) {
    check_cancelled_every(k, stop);
    sorted[place[key(items[k])]++] = items[k];
  }
  items.swap(sorted);
}

/// Calls visit(first, last) with each run [first, last) of neighbours for which same(a, b) holds.
/// Throws Error{cancelled}.
template <class Item, class Same, class Visit>
void for_each_run(const std::vector<Item>& items, Same same, Visit visit,
                  const std::stop_token& stop = {}) {
  std::size_t first = 0;
  for (std::size_t k = 1; k <= items.size(); ++k) {
    check_cancelled_every(k, stop);
    if (k < items.size() && same(items[first], items[k])) continue;
    visit(items.data() + first, items.data() + k);
    first = k;
  }
}

}  // namespace unwrapd
