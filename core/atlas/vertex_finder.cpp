// The nearest vertex is found by a sweep from the point's place among the vertices sorted by x, to
// both sides, until x alone is farther away than the best. Exact, and no tree to build: a
// constraint that names a vertex's own position touches the few vertices that share its x.
#include "core/atlas/vertex_finder.hpp"

#include <algorithm>
#include <limits>

namespace unwrapd {
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

/// The best so far of a search for the nearest.
struct Nearest {
  Index vertex = -1;
  double distance2 = std::numeric_limits<double>::infinity();

  void offer(Index v, double d2) {
    if (vertex != -1 && (d2 > distance2 || (d2 == distance2 && v > vertex))) return;
    vertex = v;
    distance2 = d2;
  }
};

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
  for (std::size_t v = 0; v < n; ++v) {
    if (begin_[v + 1] > 0) by_x_.push_back(static_cast<Index>(v));
    begin_[v + 1] += begin_[v];
  }
  corners_.resize(static_cast<std::size_t>(begin_.back()));
  std::vector<Index> next(begin_.begin(), begin_.end() - 1);
  for_each_corner([&](const ChartVertex& c) {
    corners_[static_cast<std::size_t>(next[vertex_at(c.corner)]++)] = c;
  });
  std::stable_sort(by_x_.begin(), by_x_.end(),
                   [&](Index a, Index b) { return position(a).x() < position(b).x(); });
}

const Vec3& VertexFinder::position(Index vertex) const {
  return surface_.mesh.positions[static_cast<std::size_t>(vertex)];
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
  if (by_x_.empty()) return std::nullopt;
  const auto from = std::partition_point(by_x_.begin(), by_x_.end(),
                                         [&](Index v) { return position(v).x() < point.x(); });
  Nearest best;
  const auto offer = [&](Index v) {
    const double dx = position(v).x() - point.x();
    if (dx * dx > best.distance2) return false;
    best.offer(v, (position(v) - point).squaredNorm());
    return true;
  };
  for (auto up = from; up != by_x_.end() && offer(*up);) ++up;
  for (auto down = from; down != by_x_.begin() && offer(*(down - 1));) --down;
  return best.vertex;
}

std::vector<ChartVertex> VertexFinder::at_place_of(Index vertex) const {
  const Vec3& place = position(vertex);
  auto at = std::partition_point(by_x_.begin(), by_x_.end(),
                                 [&](Index v) { return position(v).x() < place.x(); });
  std::vector<ChartVertex> found;
  for (; at != by_x_.end() && position(*at).x() == place.x(); ++at)
    if (position(*at) == place) add_corners(*at, found);
  return one_a_chart(std::move(found));
}

}  // namespace unwrapd
