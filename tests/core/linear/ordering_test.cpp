// The order of elimination: any graph's, as good as a library's, and interruptible.
#include <gtest/gtest.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <numeric>

#include "core/base/error.hpp"
#include "core/linear/elimination_tree.hpp"
#include "tests/core/linear/graphs.hpp"

namespace unwrapd::linear {
namespace {

Graph graph_of_edges(Index n, const std::vector<std::pair<Index, Index>>& edges) {
  SparseMatrix lower(n, n);
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (Index v = 0; v < n; ++v) entries.emplace_back(v, v, 1);
  for (const auto& [a, b] : edges) entries.emplace_back(std::max(a, b), std::min(a, b), 1);
  lower.setFromTriplets(entries.begin(), entries.end());
  return graph_of(lower);
}

/// Entries of the factor.
long fill(const Graph& graph, std::vector<Index> order) {
  const EliminationTree tree = elimination_tree(graph, std::move(order));
  return std::accumulate(tree.count.begin(), tree.count.end(), 0L);
}

bool names_every_vertex_once(std::vector<Index> order) {
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < order.size(); ++k)
    if (order[k] != Index(k)) return false;
  return true;
}

TEST(Ordering, FillsNoMoreThanEigensDoes) {
  double ours = 0, theirs = 0;
  for (const TriMesh& mesh : {shapes::grid(60, 60), shapes::shuffled(shapes::grid(80, 50), 3),
                              shapes::shuffled(shapes::random_disk(60, 1), 2),
                              shapes::sphere_cap(60, 40), shapes::annulus(90, 12)}) {
    const SparseMatrix lower = unit_laplacian(mesh);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> eigens;
    Eigen::AMDOrdering<Index>()(lower.selfadjointView<Eigen::Lower>(), eigens);
    const Graph graph = graph_of(lower);
    const std::vector<Index> order = fill_reducing_order(graph);
    EXPECT_TRUE(names_every_vertex_once(order));
    ours += double(fill(graph, order));
    theirs += double(fill(graph, {eigens.indices().begin(), eigens.indices().end()}));
  }
  EXPECT_LT(ours, 1.04 * theirs);
}

TEST(Ordering, FillsNothingWhereNothingNeedsTo) {
  std::vector<std::pair<Index, Index>> tree, star;
  for (Index v = 1; v < 500; ++v) tree.emplace_back(v, (v * 7 - 1) / 9), star.emplace_back(v, 0);
  for (const auto& edges : {tree, star, {}}) {
    const Graph graph = graph_of_edges(500, edges);
    const std::vector<Index> order = fill_reducing_order(graph);
    EXPECT_TRUE(names_every_vertex_once(order));
    EXPECT_EQ(fill(graph, order), 500 + long(edges.size()));
  }
}

/// A hub that all others are coupled with costs no walk over all of them at each elimination: it is
/// put last, with the fill of the rest as it was.
TEST(Ordering, PutsHubsLast) {
  std::vector<std::pair<Index, Index>> wheel;
  const Index rim = 3000;
  for (Index v = 0; v < rim; ++v) wheel.emplace_back(v, (v + 1) % rim), wheel.emplace_back(v, rim);
  const Graph graph = graph_of_edges(rim + 1, wheel);
  const std::vector<Index> order = fill_reducing_order(graph);
  EXPECT_EQ(order.back(), rim);
  EXPECT_LE(fill(graph, order), 4L * rim);  // a cycle fills 3 a vertex, the hub adds one
}

TEST(Ordering, StopsInTheMiddleWhenTold) {
  const Graph graph = graph_of(unit_laplacian(shapes::grid(20, 20)));
  std::stop_source told;
  EXPECT_NO_THROW(fill_reducing_order(graph, told.get_token()));
  told.request_stop();
  EXPECT_THROW(fill_reducing_order(graph, told.get_token()), Error);
}

}  // namespace
}  // namespace unwrapd::linear
