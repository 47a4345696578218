// The maps of both regions tell where their common border lies, twice; the motion that brings one
// to the other in least squares is a start for the map of both.
#include "core/segment/base/region_pair.hpp"

#include <cmath>

#include "core/mesh/cross.hpp"

namespace unwrapd::segment {
namespace {

constexpr std::size_t kSamples = 64;  // faces

/// A rotation about `from`, then the way to `to`.
struct Motion {
  double cosine = 1, sine = 0;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& u) const {
    const Vec2 x = u - from;
    return to + Vec2(cosine * x.x() - sine * x.y(), sine * x.x() + cosine * x.y());
  }
};

/// Of places in pairs {b, a}: the motion that brings every b near its a.
Motion motion_between(std::span<const std::array<Vec2, 2>> pairs) {
  Motion motion;
  for (const auto& [b, a] : pairs) {
    motion.from += b / static_cast<double>(pairs.size());
    motion.to += a / static_cast<double>(pairs.size());
  }
  double c = 0, s = 0;
  for (const auto& [b, a] : pairs) {
    const Vec2 x = b - motion.from, y = a - motion.to;
    c += x.dot(y);
    s += cross(x, y);
  }
  const double norm = std::hypot(c, s);
  if (norm > 0) motion.cosine = c / norm, motion.sine = s / norm;
  return motion;
}

/// Root mean square of how far each b is from its a afterwards.
double miss_of(std::span<const std::array<Vec2, 2>> pairs, const Motion& motion) {
  double sum = 0;
  for (const auto& [b, a] : pairs) sum += (motion(b) - a).squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

/// How often the sides of a closed polygon wind around the point.
int winding(std::span<const std::array<Vec2, 2>> sides, const Vec2& point) {
  int times = 0;
  for (const auto& [from, to] : sides) {
    const bool is_up = from.y() <= point.y() && to.y() > point.y();
    const bool is_down = to.y() <= point.y() && from.y() > point.y();
    if (!is_up && !is_down) continue;
    const double left = cross(to - from, point - from);
    if (is_up && left > 0) ++times;
    if (is_down && left < 0) --times;
  }
  return times;
}

}  // namespace

RegionPair::RegionPair(const SegmentationMesh& surface, const Region& a, const Region& b)
    : surface_(surface),
      a_(a),
      b_(b),
      in_a_(surface.mesh.faces.size(), a.faces),
      in_b_(surface.mesh.faces.size(), b.faces) {}

std::vector<Index> RegionPair::border(std::span<const char> open) const {
  std::vector<Index> border;
  for (const Index t : b_.faces)
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = surface_.halfedges.twin[h];
      if (twin != kNoTwin && open[h] == 0 && in_a_[face_of(twin)] >= 0) border.push_back(h);
    }
  return border;
}

/// Where the ends of those half-edges lie in both maps, {b, a}.
std::vector<std::array<Vec2, 2>> RegionPair::ends(std::span<const Index> border) const {
  std::vector<std::array<Vec2, 2>> ends;
  for (const Index h : border) {
    const Index twin = surface_.halfedges.twin[h];
    const CornerUv &own = b_.uv[in_b_[face_of(h)]], &across = a_.uv[in_a_[face_of(twin)]];
    ends.push_back({own[h % 3], across[next_halfedge(twin) % 3]});
    ends.push_back({own[next_halfedge(h) % 3], across[twin % 3]});
  }
  return ends;
}

Placement RegionPair::place(std::span<const Index> border) const {
  const std::vector<std::array<Vec2, 2>> pairs = ends(border);
  const Motion motion = motion_between(pairs);
  Placement placement{a_, miss_of(pairs, motion)};
  Region& both = placement.both;
  both.faces.insert(both.faces.end(), b_.faces.begin(), b_.faces.end());
  both.is_forced = both.is_forced || b_.is_forced;
  for (const auto& [p, q, r] : b_.uv) both.uv.push_back({motion(p), motion(q), motion(r)});
  return placement;
}

double RegionPair::miss(std::span<const Index> border) const {
  const std::vector<std::array<Vec2, 2>> pairs = ends(border);
  return miss_of(pairs, motion_between(pairs));
}

double RegionPair::covered(const Placement& placement, std::span<const char> open) const {
  const std::vector<std::array<Vec2, 2>> sides = boundary_sides(surface_, open, a_);
  double covered = 0, all = 0;
  for (std::size_t k = 0; k < b_.faces.size(); k += 1 + b_.faces.size() / kSamples) {
    const auto& [p, q, r] = placement.both.uv[a_.faces.size() + k];
    const double area = surface_.area(b_.faces[k]);
    all += area;
    if (winding(sides, (p + q + r) / 3) != 0) covered += area;
  }
  return covered / all;
}

Region beside(const SegmentationMesh& surface, const Region& a, const Region& b,
              std::span<const Index> border) {
  return RegionPair(surface, a, b).place(border).both;
}

std::vector<std::array<Vec2, 2>> boundary_sides(const SegmentationMesh& surface,
                                                std::span<const char> open, const Region& region) {
  const Ranks rank(surface.mesh.faces.size(), region.faces);
  std::vector<std::array<Vec2, 2>> sides;
  for (std::size_t k = 0; k < region.faces.size(); ++k)
    for (Index i = 0; i < 3; ++i) {
      const Index h = 3 * region.faces[k] + i, twin = surface.halfedges.twin[h];
      if (twin != kNoTwin && open[h] == 0 && rank[face_of(twin)] >= 0) continue;
      sides.push_back({region.uv[k][i], region.uv[k][(i + 1) % 3]});
    }
  return sides;
}

}  // namespace unwrapd::segment
