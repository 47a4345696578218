#pragma once
// An order of elimination that keeps the factor of a symmetric matrix sparse.

#include <span>
#include <stop_token>
#include <vector>

#include "core/linear/sparse.hpp"

namespace unwrapd::linear {

/// An adjacency list: the neighbours of vertex v are neighbour[begin[v]] ..
/// neighbour[begin[v+1]-1], without v; every pair is listed from both sides.
struct Graph {
  std::vector<Index> begin;
  std::vector<Index> neighbour;

  [[nodiscard]] Index vertex_count() const { return static_cast<Index>(begin.size()) - 1; }
  [[nodiscard]] std::span<const Index> of(Index v) const {
    const auto first = static_cast<std::size_t>(begin[static_cast<std::size_t>(v)]);
    const auto last = static_cast<std::size_t>(begin[static_cast<std::size_t>(v) + 1]);
    return std::span(neighbour).subspan(first, last - first);
  }
};

/// The pattern of a compressed lower triangle, as a graph. begin: column_count + 1 offsets into
/// row. Throws Error{cancelled}.
Graph graph_of_lower(std::span<const Index> begin, std::span<const Index> row,
                     const std::stop_token& stop = {});

/// order[k]: the vertex to eliminate k-th. Deterministic. Throws Error{cancelled}.
std::vector<Index> fill_reducing_order(const Graph& graph, const std::stop_token& stop = {});

}  // namespace unwrapd::linear
