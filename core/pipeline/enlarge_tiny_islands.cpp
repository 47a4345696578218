// The page is not known before islands are packed, but its side is no less than the root of their
// area. Rejected: to enlarge single triangles on the packed page alone, as quantize_uvs() does:
// where a whole island has a few steps, its boundary overlaps itself, or it comes nearer to others
// than the padding.
#include "core/pipeline/enlarge_tiny_islands.hpp"

#include <algorithm>
#include <cmath>

#include "core/guarantee/quantize_uvs.hpp"

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
    const Vec2 a = at(1) - at(0), b = at(2) - at(0);
    twice += std::abs(a.x() * b.y() - a.y() * b.x());
  }
  return twice / 2;
}

}  // namespace

void enlarge_tiny_islands(const std::vector<SizedIsland>& islands) {
  double area = 0;
  for (const SizedIsland& own : islands) area += area_of(own.chart->mesh.faces, *own.map);
  const double step = std::sqrt(area) * guarantee::kUvStep;
  for (const SizedIsland& own : islands) {
    const double faces = static_cast<double>(own.chart->mesh.faces.size());
    const double least = kLeastSteps * std::sqrt(faces) * step, side = longer_side(*own.map);
    if (!(side > 0) || side >= least) continue;
    for (Vec2& uv : *own.map) uv *= least / side;
  }
}

}  // namespace unwrapd::pipeline
