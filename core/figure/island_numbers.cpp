#include "core/figure/island_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/figure/painting.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/disjoint_sets.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kShare = 0.25;          // of a square of the island's area
constexpr double kLargest = 96 / 4096.;  // of the page's side

struct Island {
  double area = 0;
  Vec2 moment = Vec2::Zero();
  IslandMark mark;
  double off = std::numeric_limits<double>::infinity();
};

/// The number of the island of each face, from 0 in the order of first faces.
std::vector<Index> islands_of(const UnwrappedSurface& surface) {
  DisjointSets sets(surface.faces.size());
  const std::vector<EdgeSide> sides = sides_on_page(surface);
  for_each_run(sides, on_one_edge, [&](const EdgeSide* first, const EdgeSide* last) {
    for (const EdgeSide* side = first + 1; side < last; ++side)
      sets.join(face_of(side->halfedge), face_of(first->halfedge));
  });
  std::vector<Index> number(surface.faces.size(), -1), of_face;
  Index count = 0;
  for (Index t = 0; t < static_cast<Index>(surface.faces.size()); ++t) {
    Index& own = number[sets.root(t)];
    if (own < 0) own = count++;
    of_face.push_back(own);
  }
  return of_face;
}

Vec2 middle_of(const UnwrappedSurface& surface, std::size_t t) {
  const auto& [a, b, c] = surface.faces[t];
  return (surface.uv[a] + surface.uv[b] + surface.uv[c]) / 3;
}

double area_of(const UnwrappedSurface& surface, std::size_t t) {
  const auto& [a, b, c] = surface.faces[t];
  const Vec2 p = surface.uv[b] - surface.uv[a], q = surface.uv[c] - surface.uv[a];
  return std::abs(p.x() * q.y() - p.y() * q.x()) / 2;
}

void append_marks(const UnwrappedSurface& surface, std::vector<IslandMark>& marks) {
  const std::vector<Index> of_face = islands_of(surface);
  const Index count = of_face.empty() ? 0 : 1 + *std::ranges::max_element(of_face);
  std::vector<Island> islands(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < of_face.size(); ++t) {
    Island& island = islands[of_face[t]];
    const double area = area_of(surface, t);
    island.area += area;
    island.moment += area * middle_of(surface, t);
  }
  for (std::size_t t = 0; t < of_face.size(); ++t) {
    Island& island = islands[of_face[t]];
    const Vec2 middle = middle_of(surface, t);
    const Vec2 wanted = island.area > 0 ? Vec2(island.moment / island.area) : middle;
    const double off = (middle - wanted).norm();
    if (!(off < island.off)) continue;
    island.off = off;
    island.mark = {.middle = middle, .size = std::min(kLargest, kShare * std::sqrt(island.area))};
  }
  for (const Island& island : islands) marks.push_back(island.mark);
}

}  // namespace

std::vector<IslandMark> island_marks(std::span<const UnwrappedSurface> unwrapped) {
  std::vector<IslandMark> marks;
  for (const UnwrappedSurface& surface : unwrapped) append_marks(surface, marks);
  return marks;
}

}  // namespace unwrapd::figure
