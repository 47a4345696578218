// Each face belongs to the seeds that reach it first by a walk across the sides of triangles
// (Dijkstra on the dual graph, from both at once), so that the cut runs half way between the seeds.
// Regions grown this way are connected, and a connected region of a disk is a disk, perhaps with
// holes. If it touches itself in a vertex, that vertex is duplicated.
#include "core/charts/split_chart.hpp"

#include <limits>
#include <queue>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::charts {
namespace {

Vec3 middle(const TriMesh& mesh, Index t) {
  const auto& [a, b, c] = mesh.faces[t];
  return (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3;
}

/// side[t]: 0 or 1, the seeds that are nearer.
std::vector<int> nearer_seeds(const Chart& chart, const std::array<std::vector<Index>, 2>& seeds,
                              const std::stop_token& stop) {
  using Reached = std::pair<double, Index>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  std::vector<double> distance(chart.mesh.faces.size(), std::numeric_limits<double>::infinity());
  std::vector<int> side(distance.size(), 0);
  for (int k : {0, 1})
    for (Index t : seeds[static_cast<std::size_t>(k)]) {
      distance[t] = 0;
      side[t] = k;
      open.emplace(0, t);
    }
  for (std::size_t step = 0; !open.empty(); ++step) {
    check_cancelled_every(step, stop);
    const auto [d, t] = open.top();
    open.pop();
    if (d > distance[t]) continue;
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      if (chart.halfedges.twin[h] == kNoTwin) continue;
      const Index next = face_of(chart.halfedges.twin[h]);
      const double way = (middle(chart.mesh, next) - middle(chart.mesh, t)).norm();
      const double there = is_kept(chart.avoid, h) ? d : d + way;  // on one side together
      if (there >= distance[next]) continue;
      distance[next] = there;
      side[next] = side[t];
      open.emplace(there, next);
    }
  }
  return side;
}

/// The listed faces as a chart; rank[t]: the place of t in the list.
ChartPart part_of(const Chart& chart, const Halfedges& cut, const std::vector<Index>& faces,
                  const std::vector<Index>& rank, const std::stop_token& stop) {
  ChartPart part;
  part.face = faces;
  part.chart.least = chart.least;
  for (const Index t : faces) {
    check_cancelled_every(rank[t], stop);
    part.chart.face_source.push_back(chart.face_source[t]);
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = cut.twin[h];
      part.chart.halfedges.twin.push_back(twin == kNoTwin ? kNoTwin
                                                          : 3 * rank[twin / 3] + twin % 3);
      if (!chart.avoid.empty()) part.chart.avoid.push_back(chart.avoid[h]);
    }
  }
  CornerVertices corners = corner_vertices(part.chart.halfedges, stop);
  part.chart.mesh = {std::vector<Vec3>(corners.count), std::move(corners.faces)};
  part.vertex.resize(part.chart.mesh.positions.size());
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index v = chart.mesh.faces[faces[k]][i], own = part.chart.mesh.faces[k][i];
      part.chart.mesh.positions[own] = chart.mesh.positions[v];
      part.vertex[own] = v;
    }
  part.chart.loops = boundary_loops(part.chart.mesh, part.chart.halfedges, stop);
  return part;
}

}  // namespace

std::vector<ChartPart> parts_of(const Chart& chart, const Halfedges& cut,
                                const std::stop_token& stop) {
  const Topology pieces = topology(corner_vertices(cut, stop).faces, cut, stop);
  std::vector<std::vector<Index>> faces(pieces.components.size());
  std::vector<Index> rank(chart.mesh.faces.size());
  for (std::size_t t = 0; t < rank.size(); ++t) {
    std::vector<Index>& own = faces[pieces.component_of[t]];
    rank[t] = static_cast<Index>(own.size());
    own.push_back(static_cast<Index>(t));
  }
  std::vector<ChartPart> parts;
  for (const std::vector<Index>& own : faces) parts.push_back(part_of(chart, cut, own, rank, stop));
  return parts;
}

std::vector<ChartPart> split_chart(const Chart& chart,
                                   const std::array<std::vector<Index>, 2>& seeds,
                                   const std::stop_token& stop) {
  const std::vector<int> side = nearer_seeds(chart, seeds, stop);
  Halfedges cut = chart.halfedges;
  for (Index& twin : cut.twin) {
    const auto h = static_cast<Index>(&twin - cut.twin.data());
    if (twin != kNoTwin && side[twin / 3] != side[h / 3]) twin = kNoTwin;
  }
  return parts_of(chart, cut, stop);
}

}  // namespace unwrapd::charts
