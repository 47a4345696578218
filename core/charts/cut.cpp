// Tree-cotree cutting: Erickson and Whittlesey, "Greedy Optimal Homotopy and Homology Generators",
// SODA 2005, with one root.
//
// A shortest-path tree of the vertices; then a spanning tree of the faces across the edges that are
// left, longest detour first. The 2 * genus edges in neither tree each close a short loop through
// the root; cut along all of them, the surface is a disk. Every hole counts as one vertex: holes
// need no cut, and a path that meets one passes it for nothing.
#include "core/charts/cut.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "core/charts/seam_weight.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/disjoint_sets.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/topology.hpp"

namespace unwrapd::charts {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Vertices, with those of one hole merged, and the inner half-edges that leave each.
struct Graph {
  std::vector<Index> node_of;   ///< one a vertex; one of a node's vertices gives it its number
  std::vector<Index> arcs;      ///< half-edges with a twin, by the node they start at
  std::vector<Index> first;     ///< arcs[first[n]] .. arcs[first[n + 1]] start at node n
  std::vector<double> length;   ///< one a half-edge, by seam_weight()
  std::vector<Index> from, to;  ///< nodes of each half-edge
};

struct Paths {
  std::vector<double> distance;  ///< from the root, one a node
  std::vector<Index> via;        ///< the last half-edge of the shortest path; kNoTwin at the root
};

std::vector<Index> merge_holes(const TriMesh& mesh, const Halfedges& halfedges) {
  std::vector<Index> node_of(mesh.positions.size());
  std::iota(node_of.begin(), node_of.end(), 0);
  for (const BoundaryLoop& loop : boundary_loops(mesh, halfedges))
    for (Index h : loop) node_of[start_of(mesh.faces, h)] = start_of(mesh.faces, loop.front());
  return node_of;
}

Graph graph_of(const TriMesh& mesh, const Halfedges& halfedges, std::span<const double> avoid) {
  const std::size_t sides = halfedges.twin.size();
  Graph graph{
      merge_holes(mesh, halfedges), {}, {}, std::vector<double>(sides), std::vector<Index>(sides),
      std::vector<Index>(sides)};
  for (Index h = 0; h < static_cast<Index>(sides); ++h) {
    const Index a = start_of(mesh.faces, h), b = end_of(mesh.faces, h);
    graph.from[h] = graph.node_of[a];
    graph.to[h] = graph.node_of[b];
    graph.length[h] = seam_weight(avoid, h) * (mesh.positions[b] - mesh.positions[a]).norm();
    if (halfedges.twin[h] != kNoTwin) graph.arcs.push_back(h);
  }
  counting_sort(graph.arcs, mesh.vertex_count(), [&](Index h) { return graph.from[h]; });
  graph.first.assign(mesh.positions.size() + 1, 0);
  for (Index h : graph.arcs) ++graph.first[graph.from[h] + 1];
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  return graph;
}

/// Dijkstra.
Paths shortest_paths(const Graph& graph, Index root) {
  Paths paths{std::vector<double>(graph.node_of.size(), kFar),
              std::vector<Index>(graph.node_of.size(), kNoTwin)};
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  paths.distance[root] = 0;
  open.emplace(0.0, root);
  while (!open.empty()) {
    const auto [distance, node] = open.top();
    open.pop();
    if (distance > paths.distance[node]) continue;
    for (Index k = graph.first[node]; k < graph.first[node + 1]; ++k) {
      const Index h = graph.arcs[k];
      const double longer = distance + graph.length[h];
      if (!(longer < paths.distance[graph.to[h]])) continue;
      paths.distance[graph.to[h]] = longer;
      paths.via[graph.to[h]] = h;
      open.emplace(longer, graph.to[h]);
    }
  }
  return paths;
}

/// The farthest vertex along the longest side of the bounding box, of those that are painted least.
Index extreme_vertex(const TriMesh& mesh, std::span<const double> avoid) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::vector<double> painted(mesh.positions.size(), 0);
  for (Index h = 0; h < static_cast<Index>(avoid.size()); ++h) {
    double& own = painted[start_of(mesh.faces, h)];
    own = std::max(own, avoid[h]);
  }
  Index best = 0;
  for (Index v = 1; v < mesh.vertex_count(); ++v)
    if (std::pair(-painted[v], mesh.positions[v][axis]) >
        std::pair(-painted[best], mesh.positions[best][axis]))
      best = v;
  return best;
}

/// The half-edges on the path from node to the root.
std::vector<Index> path_to_root(const Graph& graph, const Paths& paths, Index node) {
  std::vector<Index> path;
  for (; paths.via[node] != kNoTwin; node = graph.from[paths.via[node]])
    path.push_back(paths.via[node]);
  return path;
}

/// What the way to each vertex costs beyond its length counts against the vertex.
void discount(const Graph& unpainted, Index root, std::vector<double>& distance) {
  const std::vector<double> length = shortest_paths(unpainted, root).distance;
  for (std::size_t n = 0; n < length.size(); ++n) distance[n] = 2 * length[n] - distance[n];
}

/// For a closed surface of genus 0. A path of one edge would open a slit of two half-edges.
std::vector<Index> opening_path(const TriMesh& mesh, const Halfedges& halfedges, const Graph& graph,
                                std::span<const double> avoid) {
  const Index root = graph.node_of[extreme_vertex(mesh, avoid)];
  const Paths paths = shortest_paths(graph, root);
  std::vector<double> distance = paths.distance;
  if (!avoid.empty()) discount(graph_of(mesh, halfedges, {}), root, distance);
  const Index end =
      static_cast<Index>(std::max_element(distance.begin(), distance.end()) - distance.begin());
  std::vector<Index> path = path_to_root(graph, paths, end);
  for (Index k = graph.first[end]; path.size() < 2 && k < graph.first[end + 1]; ++k)
    if (graph.to[graph.arcs[k]] != root) path.push_back(graph.arcs[k]);
  assert(path.size() >= 2);
  return path;
}

/// The edges in neither tree, one half-edge each: two for each handle.
std::vector<Index> generators(const Graph& graph, const Halfedges& halfedges, const Paths& paths) {
  std::vector<bool> in_tree(halfedges.twin.size(), false);
  for (Index h : paths.via)
    if (h != kNoTwin) in_tree[h] = in_tree[halfedges.twin[h]] = true;
  std::vector<std::pair<double, Index>> detours;  // minus the loop's length: the longest first
  for (Index h : graph.arcs)
    if (h < halfedges.twin[h] && !in_tree[h])
      detours.emplace_back(
          -(paths.distance[graph.from[h]] + graph.length[h] + paths.distance[graph.to[h]]), h);
  std::sort(detours.begin(), detours.end());
  DisjointSets dual(halfedges.twin.size() / 3);
  std::vector<Index> left;
  for (const auto& [unused, h] : detours)
    if (!dual.join(face_of(h), face_of(halfedges.twin[h]))) left.push_back(h);
  return left;
}

/// A half-edge of each edge of the generators' loops.
std::vector<Index> loop_edges(const Graph& graph, const Halfedges& halfedges, Index root) {
  const Paths paths = shortest_paths(graph, root);
  std::vector<bool> is_cut(halfedges.twin.size(), false);
  std::vector<Index> cut;
  std::vector<Index> degree(graph.node_of.size(), 0);
  const auto add = [&](Index h) {
    is_cut[h] = is_cut[halfedges.twin[h]] = true;
    cut.push_back(h);
    ++degree[graph.from[h]], ++degree[graph.to[h]];
  };
  for (Index h : generators(graph, halfedges, paths)) {
    add(h);
    for (Index end : {graph.from[h], graph.to[h]})
      for (; end != root && !is_cut[paths.via[end]]; end = graph.from[paths.via[end]])
        add(paths.via[end]);
  }
  // Both ends of a path lie on a loop, except that one branch may end at the root.
  for (Index node = root; degree[node] == 1;) {
    const auto first = graph.arcs.begin() + graph.first[node];
    const Index h = *std::find_if(first, graph.arcs.end(), [&](Index g) { return is_cut[g]; });
    is_cut[h] = is_cut[halfedges.twin[h]] = false;
    --degree[node];
    node = graph.to[h];
    --degree[node];
  }
  std::erase_if(cut, [&](Index h) { return !is_cut[h]; });
  return cut;
}

}  // namespace

void cut_to_disk(const TriMesh& mesh, Halfedges& halfedges, std::span<const double> avoid) {
  const Component shape = topology(mesh.faces, halfedges).components.front();
  if (shape.is_disk()) return;
  const Graph graph = graph_of(mesh, halfedges, avoid);
  const std::vector<Index> cut =
      shape.genus == 0 ? opening_path(mesh, halfedges, graph, avoid)
                       : loop_edges(graph, halfedges, graph.node_of[extreme_vertex(mesh, avoid)]);
  for (Index h : cut) {
    const Index other = std::exchange(halfedges.twin[h], kNoTwin);
    halfedges.twin[other] = kNoTwin;
  }
}

}  // namespace unwrapd::charts
