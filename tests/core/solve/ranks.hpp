#pragma once
// Orders in which vertices may be listed, for tests.

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::shapes {

/// Vertices as the mesh lists them.
inline std::vector<Index> as_listed(std::size_t vertex_count) {
  std::vector<Index> rank(vertex_count);
  std::iota(rank.begin(), rank.end(), 0);
  return rank;
}

inline std::vector<Index> shuffled_ranks(std::size_t vertex_count, unsigned seed) {
  std::vector<Index> rank = as_listed(vertex_count);
  std::shuffle(rank.begin(), rank.end(), std::mt19937(seed));
  return rank;
}

}  // namespace unwrapd::shapes
