// Components are found by a flood over twins; Euler characteristic and boundaries are counted per
// component.
#include "core/mesh/topology.hpp"

#include <algorithm>
#include <cassert>

#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

constexpr Index kNone = -1;

/// Gives the component `id` to every face that twins connect with `start`.
void flood(const Halfedges& halfedges, Index start, Index id, const std::stop_token& stop,
           std::vector<Index>& component_of) {
  std::vector<Index> open{start};
  component_of[start] = id;
  for (std::size_t step = 0; !open.empty(); ++step) {
    check_cancelled_every(step, stop);
    const Index t = open.back();
    open.pop_back();
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      if (halfedges.twin[h] == kNoTwin) continue;
      const Index other = face_of(halfedges.twin[h]);
      if (component_of[other] != kNone) continue;
      component_of[other] = id;
      open.push_back(other);
    }
  }
}

void count_vertices(std::span<const Triangle> faces, const std::stop_token& stop,
                    Topology& topology) {
  Index vertex_count = 0;
  for (const Triangle& face : faces)
    vertex_count = std::max({vertex_count, face[0], face[1], face[2]});
  std::vector<bool> seen(faces.empty() ? 0 : static_cast<std::size_t>(vertex_count) + 1, false);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    check_cancelled_every(t, stop);
    for (Index v : faces[t]) {
      if (seen[v]) continue;
      seen[v] = true;
      ++topology.components[topology.component_of[t]].vertices;
    }
  }
}

void mark_loop(const Halfedges& halfedges, Index start, std::vector<bool>& seen) {
  Index h = start;
  while (!seen[h]) {
    seen[h] = true;
    h = next_halfedge(h);
    while (halfedges.twin[h] != kNoTwin) h = next_halfedge(halfedges.twin[h]);
  }
}

/// Counts boundary loops, and boundary half-edges (twice the edges, less 3 a face) in `sides`.
std::vector<Index> count_boundaries(const Halfedges& halfedges, const std::stop_token& stop,
                                    Topology& topology) {
  std::vector<Index> sides(topology.components.size(), 0);
  std::vector<bool> seen(halfedges.twin.size(), false);
  for (std::size_t h = 0; h < halfedges.twin.size(); ++h) {
    check_cancelled_every(h, stop);
    if (halfedges.twin[h] != kNoTwin) continue;
    const Index component = topology.component_of[h / 3];
    ++sides[component];
    if (seen[h]) continue;
    ++topology.components[component].boundaries;
    mark_loop(halfedges, static_cast<Index>(h), seen);
  }
  return sides;
}

}  // namespace

Topology topology(std::span<const Triangle> faces, const Halfedges& halfedges,
                  const std::stop_token& stop) {
  assert(halfedges.twin.size() == 3 * faces.size());
  Topology result;
  result.component_of.assign(faces.size(), kNone);
  for (Index t = 0; t < static_cast<Index>(faces.size()); ++t) {
    if (result.component_of[t] != kNone) continue;
    flood(halfedges, t, static_cast<Index>(result.components.size()), stop, result.component_of);
    result.components.emplace_back();
  }
  for (Index id : result.component_of) ++result.components[id].faces;
  count_vertices(faces, stop, result);
  const std::vector<Index> boundary_sides = count_boundaries(halfedges, stop, result);
  for (std::size_t k = 0; k < result.components.size(); ++k) {
    Component& c = result.components[k];
    const Index edges = (3 * c.faces + boundary_sides[k]) / 2;
    c.euler = c.vertices - edges + c.faces;
    c.genus = (2 - c.boundaries - c.euler) / 2;
  }
  return result;
}

CornerVertices corner_vertices(const Halfedges& halfedges, const std::stop_token& stop) {
  const std::vector<Index>& twin = halfedges.twin;
  CornerVertices result;
  result.faces.assign(twin.size() / 3, {kNone, kNone, kNone});
  const auto vertex_at = [&](Index h) -> Index& { return result.faces[h / 3][h % 3]; };
  for (Index start = 0; start < static_cast<Index>(twin.size()); ++start) {
    check_cancelled_every(start, stop);
    if (vertex_at(start) != kNone) continue;
    const Index id = result.count++;
    Index h = start;
    do {  // counter-clockwise until the fan closes or ends
      vertex_at(h) = id;
      h = twin[previous_halfedge(h)];
    } while (h != kNoTwin && h != start);
    if (h == start) continue;
    for (h = start; twin[h] != kNoTwin;) {  // the rest of an open fan, clockwise
      h = next_halfedge(twin[h]);
      vertex_at(h) = id;
    }
  }
  return result;
}

}  // namespace unwrapd
