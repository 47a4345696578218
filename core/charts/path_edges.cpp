#include "core/charts/path_edges.hpp"

#include <algorithm>
#include <utility>

#include "core/base/error.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::charts {
namespace {

[[noreturn]] void refuse_path(const PathName& name, const std::string& why) {
  throw Error(ErrorCode::invalid_option, name.option + ": " + why,
              "/" + name.option + "/" + std::to_string(name.number));
}

std::string ends_of(const EdgeEnds& edge) {
  return std::to_string(edge[0]) + " and " + std::to_string(edge[1]);
}

EdgeEnds welded_edge(std::span<const Triangle> welded, Index h) {
  const Index a = start_of(welded, h), b = end_of(welded, h);
  return {std::min(a, b), std::max(a, b)};
}

/// Every edge of paths on the surface, with the number of its path.
using NumberedEdges = std::vector<std::pair<EdgeEnds, std::size_t>>;

NumberedEdges numbered_edges(std::span<const SeamPath> paths, Index surface,
                             std::span<const Index> first_at, const std::string& option) {
  NumberedEdges edges;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (paths[k].surface != surface) continue;
    for (const EdgeEnds& edge : path_edges(first_at, paths[k], {option, k}))
      edges.emplace_back(edge, k);
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void require_edges(const NumberedEdges& kept, std::span<const EdgeEnds> edges,
                   std::span<const Triangle> welded) {
  std::vector<char> is_found(edges.size(), 0);
  for (Index h = 0; h < static_cast<Index>(3 * welded.size()); ++h) {
    const EdgeEnds edge = welded_edge(welded, h);
    const auto at = std::lower_bound(edges.begin(), edges.end(), edge);
    if (at != edges.end() && *at == edge)
      is_found[static_cast<std::size_t>(at - edges.begin())] = 1;
  }
  for (const auto& [edge, path] : kept) {
    const auto at = std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin();
    if (is_found[static_cast<std::size_t>(at)] == 0) refuse_missing({"keep_edges", path}, edge);
  }
}

/// Whether the edge of half-edge h is in an ascending list.
bool contains_edge(std::span<const EdgeEnds> edges, std::span<const Triangle> welded, Index h) {
  return std::binary_search(edges.begin(), edges.end(), welded_edge(welded, h));
}

}  // namespace

std::vector<EdgeEnds> path_edges(std::span<const Index> first_at, const SeamPath& path,
                                 const PathName& name) {
  const auto count = static_cast<Index>(first_at.size());
  std::vector<EdgeEnds> edges;
  for (std::size_t k = 0; k < path.vertices.size(); ++k) {
    const Index v = path.vertices[k];
    if (v < 0 || v >= count)
      refuse_path(name, "there is no vertex " + std::to_string(v) + " in a mesh of " +
                            std::to_string(count) + "; give vertices of this mesh");
    if (k == 0) continue;
    const auto ends = std::minmax(first_at[static_cast<std::size_t>(path.vertices[k - 1])],
                                  first_at[static_cast<std::size_t>(v)]);
    edges.push_back({ends.first, ends.second});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void refuse_missing(const PathName& name, const EdgeEnds& edge) {
  refuse_path(
      name, "no edge joins vertices " + ends_of(edge) + "; give vertices that are joined by edges");
}

std::vector<EdgeEnds> kept_edges(const SeamRules& seams, std::span<const Index> first_at,
                                 std::span<const Triangle> welded) {
  const NumberedEdges kept = numbered_edges(seams.kept, seams.surface, first_at, "keep_edges");
  std::vector<EdgeEnds> edges;
  if (kept.empty()) return edges;
  for (const auto& [edge, unused] : kept) edges.push_back(edge);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  require_edges(kept, edges, welded);
  const NumberedEdges cut = numbered_edges(seams.paths, seams.surface, first_at, "seam_edges");
  for (const auto& [edge, path] : kept) {
    const auto at =
        std::ranges::lower_bound(cut, edge, {}, [](const auto& own) { return own.first; });
    if (at != cut.end() && at->first == edge)
      refuse_path({"keep_edges", path}, "the edge between vertices " + ends_of(edge) +
                                            " is in seam_edges/" + std::to_string(at->second) +
                                            ", too; leave it out of one of them");
  }
  return edges;
}

void mark_kept(std::span<const Triangle> welded, std::span<const EdgeEnds> kept, Chart& chart) {
  for (Index h = 0; h < static_cast<Index>(chart.halfedges.twin.size()); ++h) {
    if (chart.halfedges.twin[h] == kNoTwin ||
        !contains_edge(kept, welded, 3 * chart.face_source[h / 3] + h % 3))
      continue;
    if (chart.avoid.empty()) chart.avoid.assign(chart.halfedges.twin.size(), 0);
    chart.avoid[h] = kKept;
  }
}

}  // namespace unwrapd::charts
