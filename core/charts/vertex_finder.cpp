// Corners are sorted by the surface's vertices with a counting sort, so that a vertex is looked up
// in time of its corners.
#include "core/charts/vertex_finder.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::charts {
namespace {

/// Keeps the lowest corner of each chart.
std::vector<ChartVertex> one_a_chart(std::vector<ChartVertex> found) {
  const auto before = [](const ChartVertex& a, const ChartVertex& b) {
    return a.chart != b.chart ? a.chart < b.chart : a.corner < b.corner;
  };
  const auto same_chart = [](const ChartVertex& a, const ChartVertex& b) {
    return a.chart == b.chart;
  };
  std::sort(found.begin(), found.end(), before);
  found.erase(std::unique(found.begin(), found.end(), same_chart), found.end());
  return found;
}

}  // namespace

VertexFinder::VertexFinder(const Surface& surface, const Charts& charts) : surface_(surface) {
  const auto n = static_cast<std::size_t>(surface.mesh.vertex_count());
  begin_.assign(n + 1, 0);
  const auto for_each_corner = [&](auto visit) {
    for (std::size_t k = 0; k < charts.charts.size(); ++k) {
      const Chart& chart = charts.charts[k];
      for (std::size_t t = 0; t < chart.face_source.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
          visit(ChartVertex{static_cast<Index>(k), chart.mesh.faces[t][i],
                            3 * chart.face_source[t] + static_cast<Index>(i)});
    }
  };
  const auto vertex_at = [&](Index corner) {
    const Triangle& face = surface.mesh.faces[static_cast<std::size_t>(corner / 3)];
    return static_cast<std::size_t>(face[static_cast<std::size_t>(corner % 3)]);
  };
  for_each_corner([&](const ChartVertex& c) { ++begin_[vertex_at(c.corner) + 1]; });
  std::vector<Index> shown;
  for (std::size_t v = 0; v < n; ++v) {
    if (begin_[v + 1] > 0) shown.push_back(static_cast<Index>(v));
    begin_[v + 1] += begin_[v];
  }
  corners_.resize(static_cast<std::size_t>(begin_.back()));
  std::vector<Index> next(begin_.begin(), begin_.end() - 1);
  for_each_corner([&](const ChartVertex& c) {
    corners_[static_cast<std::size_t>(next[vertex_at(c.corner)]++)] = c;
  });
  places_.emplace(surface.mesh.positions, std::move(shown));
}

void VertexFinder::add_corners(Index vertex, std::vector<ChartVertex>& found) const {
  const auto v = static_cast<std::size_t>(vertex);
  found.insert(found.end(), corners_.begin() + begin_[v], corners_.begin() + begin_[v + 1]);
}

std::vector<ChartVertex> VertexFinder::of_vertex(Index vertex) const {
  std::vector<ChartVertex> found;
  add_corners(vertex, found);
  return one_a_chart(std::move(found));
}

std::optional<Index> VertexFinder::nearest(const Vec3& point) const {
  return places_->nearest(point);
}

std::vector<ChartVertex> VertexFinder::at_place_of(Index vertex) const {
  std::vector<ChartVertex> found;
  const Vec3& place = surface_.mesh.positions[static_cast<std::size_t>(vertex)];
  for (Index v : places_->at(place)) add_corners(v, found);
  return one_a_chart(std::move(found));
}

}  // namespace unwrapd::charts
