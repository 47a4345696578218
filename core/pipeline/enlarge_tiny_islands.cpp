// The page is not known before islands are packed, but its side is no less than the root of their
// area. Rejected: to enlarge single triangles on the packed page alone, as quantize_uvs() does:
// where a whole island has a few steps, its boundary overlaps itself, or it comes nearer to others
// than the padding.
#include "core/pipeline/enlarge_tiny_islands.hpp"

#include <algorithm>
#include <cmath>

#include "core/guarantee/quantize_uvs.hpp"
#include "core/mesh/cross.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kLeastSteps = 256;  // of the longer side of an island, for each root of its faces

double longer_side(const UvMap& map) {
  Vec2 low = map.front(), high = low;
  for (const Vec2& uv : map) {
    low = low.cwiseMin(uv);
    high = high.cwiseMax(uv);
  }
  return (high - low).maxCoeff();
}

double area_of(const std::vector<Triangle>& faces, const UvMap& map) {
  double twice = 0;
  for (const Triangle& face : faces) {
    const auto at = [&](int i) { return map[static_cast<std::size_t>(face[i])]; };
    twice += std::abs(cross(at(1) - at(0), at(2) - at(0)));
  }
  return twice / 2;
}

/// visit(faces, map)
template <class Visit>
void for_each_island(Layout& layout, Visit visit) {
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k)
      visit(layout.charts[s][k]->mesh.faces, layout.islands[s][k]);
}

}  // namespace

void enlarge_tiny_islands(Layout& layout) {
  double area = 0;
  for_each_island(layout,
                  [&](const auto& faces, const UvMap& map) { area += area_of(faces, map); });
  const double step = std::sqrt(area) * guarantee::kUvStep;
  for_each_island(layout, [&](const auto& faces, UvMap& map) {
    const double least = kLeastSteps * std::sqrt(static_cast<double>(faces.size())) * step;
    const double side = longer_side(map);
    if (!(side > 0) || side >= least) return;
    for (Vec2& uv : map) uv *= least / side;
  });
}

}  // namespace unwrapd::pipeline
