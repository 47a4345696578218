// Approximate minimum degree (Amestoy, Davis, Duff 1996), Eigen's implementation. Rejected: AMD on
// the graph of matched pairs of vertices, half its time for 20 to 55 % more fill, and vertices
// renumbered along a breadth-first walk first, no gain (docs/adr/0016).
#include "core/linear/ordering.hpp"

#include <Eigen/OrderingMethods>

#include <numeric>

namespace unwrapd {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Pattern = Eigen::SparseMatrix<char, Eigen::ColMajor, Index>;

/// The lower triangle of the graph; the values say nothing. Without its diagonal entry Eigen would
/// take a vertex for a dense one.
Pattern pattern_of(const Graph& graph) {
  const Index n = graph.vertex_count();
  Pattern lower(n, n);
  lower.reserve(static_cast<Index>(graph.neighbour.size()) / 2 + n);
  for (Index v = 0; v < n; ++v) {
    lower.startVec(v);
    lower.insertBackByOuterInnerUnordered(v, v) = 1;
    for (Index w : graph.of(v))
      if (w > v) lower.insertBackByOuterInnerUnordered(v, w) = 1;
  }
  lower.finalize();
  return lower;
}

}  // namespace

Graph graph_of_lower(std::span<const Index> begin, std::span<const Index> row) {
  const std::size_t n = begin.size() - 1;
  Graph graph{std::vector<Index>(n + 1, 0), {}};
  const auto for_each_entry = [&](auto visit) {
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t p = at(begin[j]); p < at(begin[j + 1]); ++p)
        if (at(row[p]) != j) visit(at(row[p]), j);
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

std::vector<Index> fill_reducing_order(const Graph& graph) {
  const Pattern lower = pattern_of(graph);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
  Eigen::AMDOrdering<Index>()(lower.selfadjointView<Eigen::Lower>(), order);
  return {order.indices().begin(), order.indices().end()};
}

}  // namespace unwrapd
