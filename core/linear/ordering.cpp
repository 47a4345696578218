// Approximate minimum degree. Rejected: ordering the graph of matched pairs of vertices, which
// takes half the time but has 20 to 55 % more fill; renumbering vertices along a breadth-first walk
// first, which gains nothing (docs/adr/0016).
#include "core/linear/ordering.hpp"

#include <numeric>

#include "core/base/cancel.hpp"
#include "core/linear/minimum_degree.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {}  // namespace

Graph graph_of_lower(std::span<const Index> begin, std::span<const Index> row,
                     const std::stop_token& stop) {
  const std::size_t n = begin.size() - 1;
  Graph graph{std::vector<Index>(n + 1, 0), {}};
  const auto for_each_entry = [&](auto visit) {
    for (std::size_t j = 0; j < n; ++j) {
      check_cancelled_every(j, stop);
      for (std::size_t p = at(begin[j]); p < at(begin[j + 1]); ++p)
        if (at(row[p]) != j) visit(at(row[p]), j);
    }
  };
  for_each_entry([&](std::size_t i, std::size_t j) { ++graph.begin[i + 1], ++graph.begin[j + 1]; });
  std::partial_sum(graph.begin.begin(), graph.begin.end(), graph.begin.begin());
  graph.neighbour.resize(at(graph.begin[n]));
  std::vector<Index> next(graph.begin.begin(), graph.begin.end() - 1);
  for_each_entry([&](std::size_t i, std::size_t j) {
    graph.neighbour[at(next[i]++)] = static_cast<Index>(j);
    graph.neighbour[at(next[j]++)] = static_cast<Index>(i);
  });
  return graph;
}

std::vector<Index> fill_reducing_order(const Graph& graph, const std::stop_token& stop) {
  return MinimumDegree(graph).run(stop);
}

}  // namespace unwrapd::linear
