#pragma once
// Vertices of a disk that are held in the plane (Sec. 7).

#include <span>
#include <vector>

#include "core/linear/eliminate.hpp"

namespace unwrapd {

/// A vertex that lies exactly at a place, in disk units.
struct FixedPoint {
  Index vertex = 0;
  Vec2 at = Vec2::Zero();
};

/// A vertex that is drawn to a place: adds weight |u_v - at|^2 to the energy of the disk.
struct Spring {
  Index vertex = 0;
  Vec2 at = Vec2::Zero();
  double weight = 1;  ///< finite, > 0
};

/// No vertex occurs twice.
struct Holds {
  std::vector<FixedPoint> fixed;
  std::vector<Spring> springs;

  [[nodiscard]] bool empty() const { return fixed.empty() && springs.empty(); }
  [[nodiscard]] std::size_t count() const { return fixed.size() + springs.size(); }
};

/// Numbers the vertices that are not fixed.
inline FreeVertices free_vertices(std::size_t vertex_count, const Holds& holds) {
  std::vector<char> fixed(vertex_count, 0);
  for (const FixedPoint& point : holds.fixed) fixed[static_cast<std::size_t>(point.vertex)] = 1;
  return number_free(fixed);
}

/// What the springs add to the energy of the map uv.
inline double spring_energy(const Holds& holds, std::span<const Vec2> uv) {
  double energy = 0;
  for (const Spring& spring : holds.springs)
    energy +=
        spring.weight * (uv[static_cast<std::size_t>(spring.vertex)] - spring.at).squaredNorm();
  return energy;
}

}  // namespace unwrapd
