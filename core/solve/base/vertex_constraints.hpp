#pragma once
// Vertices of a disk that are constrained in the plane (Sec. 7).

#include <algorithm>
#include <span>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/types/cache_key.hpp"

namespace unwrapd::solve {

/// A vertex fixed exactly at a position, in disk units.
struct HardConstraint {
  Index vertex = 0;
  Vec2 at = Vec2::Zero();
};

/// A vertex pulled towards a position: adds weight |u_v - at|^2 to the energy of the disk.
struct SoftConstraint {
  Index vertex = 0;
  Vec2 at = Vec2::Zero();
  double weight = 1;  ///< finite, > 0
};

/// No vertex occurs twice.
struct VertexConstraints {
  std::vector<HardConstraint> hard;
  std::vector<SoftConstraint> soft;

  [[nodiscard]] bool empty() const { return hard.empty() && soft.empty(); }
  [[nodiscard]] std::size_t count() const { return hard.size() + soft.size(); }
};

/// The constraints, and a map that satisfies the hard ones, from which the iterations may start.
/// Without constraints both are empty.
struct ConstrainedStart {
  VertexConstraints constraints;
  UvMap start;
};

/// One entry a vertex: 1 if it has a hard constraint.
inline std::vector<char> fixed_vertices(std::size_t vertex_count,
                                        const VertexConstraints& constraints) {
  std::vector<char> hard(vertex_count, 0);
  for (const HardConstraint& point : constraints.hard)
    hard[static_cast<std::size_t>(point.vertex)] = 1;
  return hard;
}

/// Numbers the vertices without a hard constraint.
inline linear::FreeVertices free_vertices(std::size_t vertex_count,
                                          const VertexConstraints& constraints) {
  return linear::number_free(fixed_vertices(vertex_count, constraints));
}

/// Positions with their V times this: from UVs to units of the page's width.
inline VertexConstraints stretched_v(VertexConstraints constraints, double aspect) {
  for (HardConstraint& p : constraints.hard) p.at.y() *= aspect;
  for (SoftConstraint& s : constraints.soft) s.at.y() *= aspect;
  return constraints;
}

inline void describe(CacheKey& key, const HardConstraint& point) {
  const auto& [vertex, at] = point;
  key.add(vertex).add(at);
}
inline void describe(CacheKey& key, const SoftConstraint& soft_constraint) {
  const auto& [vertex, at, weight] = soft_constraint;
  key.add(vertex).add(at).add(weight);
}
inline void describe(CacheKey& key, const VertexConstraints& constraints) {
  const auto& [hard, soft] = constraints;
  key.add(hard).add(soft);
}

/// Whether both constrain the same vertices with the same weights; positions may differ.
inline bool is_moved(const VertexConstraints& a, const VertexConstraints& b) {
  const auto same_vertex = [](const HardConstraint& p, const HardConstraint& q) {
    return p.vertex == q.vertex;
  };
  const auto same_soft = [](const SoftConstraint& p, const SoftConstraint& q) {
    return p.vertex == q.vertex && p.weight == q.weight;
  };
  return std::ranges::equal(a.hard, b.hard, same_vertex) &&
         std::ranges::equal(a.soft, b.soft, same_soft);
}

/// The energy that the soft constraints add to the map uv.
inline double soft_constraint_energy(std::span<const SoftConstraint> soft,
                                     std::span<const Vec2> uv) {
  double energy = 0;
  for (const SoftConstraint& soft_constraint : soft)
    energy +=
        soft_constraint.weight *
        (uv[static_cast<std::size_t>(soft_constraint.vertex)] - soft_constraint.at).squaredNorm();
  return energy;
}
inline double soft_constraint_energy(const VertexConstraints& constraints,
                                     std::span<const Vec2> uv) {
  return soft_constraint_energy(constraints.soft, uv);
}

}  // namespace unwrapd::solve
