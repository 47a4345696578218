#pragma once
// Vertices of a disk that are held in the plane (Sec. 7).

#include <algorithm>
#include <span>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/types/fingerprint.hpp"

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

/// What is held, and a map from which the iterations may start: fixed vertices lie at their places.
/// All empty: nothing is held.
struct Held {
  Holds holds;
  UvMap start;
};

/// One a vertex: 1 where it is fixed.
inline std::vector<char> fixed_vertices(std::size_t vertex_count, const Holds& holds) {
  std::vector<char> fixed(vertex_count, 0);
  for (const FixedPoint& point : holds.fixed) fixed[static_cast<std::size_t>(point.vertex)] = 1;
  return fixed;
}

/// Numbers the vertices that are not fixed.
inline FreeVertices free_vertices(std::size_t vertex_count, const Holds& holds) {
  return number_free(fixed_vertices(vertex_count, holds));
}

inline void describe(Fingerprint& key, const FixedPoint& point) {
  const auto& [vertex, at] = point;
  key.add(vertex).add(at);
}
inline void describe(Fingerprint& key, const Spring& spring) {
  const auto& [vertex, at, weight] = spring;
  key.add(vertex).add(at).add(weight);
}
inline void describe(Fingerprint& key, const Holds& holds) {
  const auto& [fixed, springs] = holds;
  key.add(fixed).add(springs);
}

/// Whether both hold the same vertices with the same weights, be it at other places.
inline bool is_moved(const Holds& a, const Holds& b) {
  const auto same_vertex = [](const FixedPoint& p, const FixedPoint& q) {
    return p.vertex == q.vertex;
  };
  const auto same_spring = [](const Spring& p, const Spring& q) {
    return p.vertex == q.vertex && p.weight == q.weight;
  };
  return std::ranges::equal(a.fixed, b.fixed, same_vertex) &&
         std::ranges::equal(a.springs, b.springs, same_spring);
}

/// What the springs add to the energy of the map uv.
inline double spring_energy(std::span<const Spring> springs, std::span<const Vec2> uv) {
  double energy = 0;
  for (const Spring& spring : springs)
    energy +=
        spring.weight * (uv[static_cast<std::size_t>(spring.vertex)] - spring.at).squaredNorm();
  return energy;
}
inline double spring_energy(const Holds& holds, std::span<const Vec2> uv) {
  return spring_energy(holds.springs, uv);
}

}  // namespace unwrapd
