#pragma once
// Rotates, scales and moves a map to the targets of its constrained vertices.

#include <span>

#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve {

/// An orientation-preserving similarity: maps u to `to` + scale * rotation * (u - from).
struct Alignment {
  double cosine = 1;
  double sine = 0;
  double scale = 1;
  Vec2 from = Vec2::Zero();
  Vec2 to = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& u) const {
    const Vec2 d = u - from;
    return to + scale * Vec2(cosine * d.x() - sine * d.y(), sine * d.x() + cosine * d.y());
  }
};

/// The similarity after which the constrained vertices of uv have the mean and the mean squared
/// distance from it that their targets have, rotated as near to the targets as possible. A hard
/// constraint has weight 1, a soft one of weight w has w / (1 + w). A single constrained vertex is
/// moved, neither rotated nor scaled. constraints is not empty; two or more must not all be at one
/// position.
Alignment align(std::span<const Vec2> uv, const VertexConstraints& constraints);

/// Aligns the map with the constraints, then puts the hard-constrained vertices exactly in place.
UvMap constrained_start(UvMap uv, const VertexConstraints& constraints);

}  // namespace unwrapd::solve
