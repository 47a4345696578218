#include "core/figure/seam_lines.hpp"

#include <algorithm>

#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::figure {

std::vector<SeamLine> seam_lines(const Surface& surface, const UnwrappedSurface& unwrapped) {
  const std::vector<Index> place = weld(surface.mesh.positions);
  std::vector<SeamLine> lines;
  std::vector<EdgeSide> sides;  // by the line's number instead of a half-edge's
  for (const Edge& edge : outline(unwrapped)) {
    const Index a = place[unwrapped.source[edge[0]]], b = place[unwrapped.source[edge[1]]];
    sides.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(lines.size())});
    lines.push_back({.edge = edge, .is_seam = false});
  }
  sort_by_edge(sides, surface.mesh.vertex_count());
  for_each_run(sides, on_one_edge, [&](const EdgeSide* first, const EdgeSide* last) {
    for (const EdgeSide* side = first; side < last; ++side)
      lines[side->halfedge].is_seam = last - first > 1;
  });
  return lines;
}

}  // namespace unwrapd::figure
