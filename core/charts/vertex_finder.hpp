#pragma once
// From a vertex of a surface, or a point in space, to vertices of its charts.

#include <optional>
#include <span>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/point_tree.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::charts {

/// A vertex of a chart, and the lowest corner 3t + i of the surface at which the chart uses it for
/// the vertex that was looked for.
struct ChartVertex {
  Index chart = 0;
  Index vertex = 0;
  Index corner = 0;
};

/// Finds the vertices of charts that come from a vertex of their surface.
class VertexFinder {
 public:
  /// surface must outlive the finder.
  VertexFinder(const Surface& surface, const Charts& charts);

  /// One vertex of each chart in which the surface's vertex occurs, in the order of charts; empty
  /// if no chart uses it. vertex is in range.
  [[nodiscard]] std::vector<ChartVertex> of_vertex(Index vertex) const;

  /// The vertex nearest to a point, the lowest of equally near ones; empty without charts.
  [[nodiscard]] std::optional<Index> nearest(const Vec3& point) const;

  /// As of_vertex(), for all vertices at exactly this vertex's position.
  [[nodiscard]] std::vector<ChartVertex> at_place_of(Index vertex) const;

 private:
  void add_corners(Index vertex, std::vector<ChartVertex>& found) const;

  const Surface& surface_;
  std::vector<Index> begin_;          // of each vertex's corners; one entry more than vertices
  std::vector<ChartVertex> corners_;  // by vertex, then by corner
  std::optional<PointTree> places_;   // of the vertices that charts use
};

}  // namespace unwrapd::charts
