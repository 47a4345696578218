#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <random>

#include "core/linear/supernodal.hpp"
#include "tests/core/linear/graphs.hpp"

namespace unwrapd::linear {
namespace {

std::vector<Index> random_order(Index n, unsigned seed) {
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

using Flags = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Which entries of the factor may be nonzero, by eliminating one column after the other.
Flags dense_fill(const Graph& graph, const std::vector<Index>& order) {
  const auto n = Eigen::Index(order.size());
  Flags full = Flags::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) full(k, k) = true;
  for (Eigen::Index k = 0; k < n; ++k)
    for (Index w : graph.of(order[std::size_t(k)]))
      full(k, std::find(order.begin(), order.end(), w) - order.begin()) = true;
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index j = k + 1; j < n; ++j)
      for (Eigen::Index i = k + 1; i < n; ++i)
        if (full(i, k) && full(j, k)) full(i, j) = true;
  return full.triangularView<Eigen::Lower>();
}

std::vector<TriMesh> meshes() {
  return {
      shapes::random_disk(6, 1),
      shapes::shuffled(shapes::random_disk(7, 2), 3),
      shapes::sphere_cap(12, 4),
      shapes::annulus(9, 3),
      shapes::polar_disk(40, 1, shapes::kTurn, [](double r, double a) { return Vec3(r, a, 0); }),
      shapes::merged(std::vector{shapes::random_disk(3, 4), shapes::random_disk(4, 5)})};
}

TEST(Graph, ListsEveryEdgeFromBothEnds) {
  const TriMesh mesh = shapes::shuffled(shapes::random_disk(5, 1), 2);
  const SparseMatrix lower = unit_laplacian(mesh);
  const Graph graph = graph_of(lower);
  EXPECT_EQ(Index(graph.neighbour.size()), 2 * (lower.nonZeros() - lower.cols()));
  for (Index v = 0; v < graph.vertex_count(); ++v)
    for (Index w : graph.of(v)) {
      EXPECT_NE(w, v);
      EXPECT_NE(lower.coeff(std::max(v, w), std::min(v, w)), 0);
    }
}

TEST(EliminationTree, PostordersItsParents) {
  for (const TriMesh& mesh : meshes()) {
    const Graph graph = graph_of(mesh);
    const EliminationTree tree = elimination_tree(graph, random_order(graph.vertex_count(), 7));
    std::vector<Index> size(tree.parent.size(), 1);  // of the subtree: the columns just before it
    for (std::size_t k = 0; k < tree.parent.size(); ++k) {
      EXPECT_EQ(tree.position[std::size_t(tree.order[k])], Index(k));
      const Index parent = tree.parent[k];
      if (parent == kNoParent) continue;
      ASSERT_GT(parent, Index(k));
      size[std::size_t(parent)] += size[k];
    }
    for (std::size_t k = 0; k < tree.parent.size(); ++k)
      for (std::size_t j = k + 1 - std::size_t(size[k]); j < k; ++j)
        EXPECT_LE(tree.parent[j], Index(k));
  }
}

TEST(EliminationTree, CountsTheEntriesOfTheFactor) {
  for (const TriMesh& mesh : meshes()) {
    const Graph graph = graph_of(mesh);
    const EliminationTree tree = elimination_tree(graph, random_order(graph.vertex_count(), 8));
    const Flags fill = dense_fill(graph, tree.order);
    for (Eigen::Index k = 0; k < fill.cols(); ++k) {
      EXPECT_EQ(tree.count[std::size_t(k)], fill.col(k).count());
      Eigen::Index below = k + 1;
      while (below < fill.rows() && !fill(below, k)) ++below;
      EXPECT_EQ(tree.parent[std::size_t(k)], below == fill.rows() ? kNoParent : Index(below));
    }
  }
}

TEST(Supernodes, CoverTheFactorWithBlocks) {
  for (const TriMesh& mesh : meshes()) {
    const Graph graph = graph_of(mesh);
    const Supernodes nodes = analyse(graph);
    const Flags fill = dense_fill(graph, nodes.order);
    Flags covered = Flags::Zero(fill.rows(), fill.cols());
    ASSERT_EQ(nodes.first.back(), graph.vertex_count());
    for (std::size_t s = 0; s < nodes.count(); ++s) {
      EXPECT_TRUE(std::is_sorted(nodes.below(s).begin(), nodes.below(s).end()));
      for (Index k = nodes.first[s]; k < nodes.first[s + 1]; ++k) {
        for (Index i = k; i < nodes.first[s + 1]; ++i) covered(i, k) = true;
        for (Index i : nodes.below(s)) {
          EXPECT_GE(i, nodes.first[s + 1]);
          covered(i, k) = true;
        }
      }
    }
    EXPECT_EQ((fill.array() && !covered.array()).count(), 0);
    EXPECT_LT(covered.count(), 3 * fill.count());  // merging stores zeros, but not too many
  }
}

TEST(Supernodes, KeepTheOrderThatIsGiven) {
  for (const TriMesh& mesh : meshes()) {
    const Graph graph = graph_of(mesh);
    const std::vector<Index> order = random_order(graph.vertex_count(), 9);
    const Supernodes nodes = analyse(graph, order, {});
    EXPECT_EQ(dense_fill(graph, nodes.order).count(), dense_fill(graph, order).count());
  }
}

TEST(Supernodes, PileTheirUpdatesInPostorder) {
  for (const TriMesh& mesh : meshes()) {
    const Supernodes nodes = analyse(graph_of(mesh));
    std::vector<std::size_t> pile;
    for (std::size_t s = 0; s < nodes.count(); ++s) {
      for (Index c = 0; c < nodes.child_count[s]; ++c) {
        ASSERT_FALSE(pile.empty());
        for (Index row : nodes.below(pile.back()))  // a child's rows are its parent's
          EXPECT_TRUE((row >= nodes.first[s] && row < nodes.first[s + 1]) ||
                      std::binary_search(nodes.below(s).begin(), nodes.below(s).end(), row));
        pile.pop_back();
      }
      if (nodes.below(s).empty()) continue;
      pile.push_back(s);
    }
    EXPECT_TRUE(pile.empty());
  }
}

}  // namespace
}  // namespace unwrapd::linear
