#include "tests/bench/creases.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <vector>

namespace unwrapd::bench {
namespace {

/// A surface beside what is written of it, by half-edges 3t + i.
class Sides {
 public:
  Sides(const Surface& surface, const UnwrappedSurface& unwrapped)
      : surface_(surface), unwrapped_(unwrapped) {}

  using Place = std::array<double, 3>;

  static Index next(Index h) { return h - h % 3 + (h + 1) % 3; }
  [[nodiscard]] const Vec3& point(Index h) const {
    return surface_.mesh.positions[std::size_t(vertex(h))];
  }
  [[nodiscard]] Place place(Index h) const { return {point(h).x(), point(h).y(), point(h).z()}; }

  /// Half-edges by the places of their ends.
  [[nodiscard]] std::map<std::array<Place, 2>, std::vector<Index>> by_edge() const {
    std::map<std::array<Place, 2>, std::vector<Index>> sides;
    for (Index h = 0; h < Index(3 * surface_.mesh.faces.size()); ++h) {
      const Place a = place(h), b = place(next(h));
      sides[{std::min(a, b), std::max(a, b)}].push_back(h);
    }
    return sides;
  }

  [[nodiscard]] bool is_seam(Index g, Index h) const {
    return uv(g) != uv(next(h)) || uv(next(g)) != uv(h);
  }
  [[nodiscard]] bool is_crease(Index g, Index h) const {
    return normal(g).dot(normal(h)) < 0.788 || vertex(g) != vertex(next(h)) ||
           vertex(next(g)) != vertex(h) ||
           surface_.part[std::size_t(g / 3)] != surface_.part[std::size_t(h / 3)];
  }

 private:
  [[nodiscard]] Index vertex(Index h) const {
    return surface_.mesh.faces[std::size_t(h / 3)][std::size_t(h % 3)];
  }
  [[nodiscard]] const Vec2& uv(Index h) const {
    return unwrapped_.uv[std::size_t(unwrapped_.faces[std::size_t(h / 3)][std::size_t(h % 3)])];
  }
  [[nodiscard]] Vec3 normal(Index h) const {
    const Vec3 along = point(next(h)) - point(h), across = point(next(next(h))) - point(h);
    return along.cross(across).stableNormalized();
  }

  const Surface& surface_;
  const UnwrappedSurface& unwrapped_;
};

}  // namespace

double share_on_creases(std::span<const Surface> surfaces,
                        std::span<const UnwrappedSurface> unwrapped) {
  double all = 0, on_creases = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Sides sides(surfaces[s], unwrapped[s]);
    for (const auto& [ends, both] : sides.by_edge()) {
      if (both.size() != 2 || sides.place(both[0]) != sides.place(Sides::next(both[1]))) continue;
      if (!sides.is_seam(both[0], both[1])) continue;
      const double length = (sides.point(both[0]) - sides.point(both[1])).norm();
      all += length;
      on_creases += sides.is_crease(both[0], both[1]) ? length : 0;
    }
  }
  return all > 0 ? on_creases / all : 0;
}

}  // namespace unwrapd::bench
