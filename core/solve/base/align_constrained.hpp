#pragma once
// A map turned, scaled and moved to where its constrained vertices shall lie.

#include <span>

#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve {

/// A similarity that does not mirror: u goes to `to` + scale * rotation * (u - from).
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

/// Takes the constrained vertices of uv to places of the same mean and the same mean square
/// distance from it as those where they shall lie, turned so as to lie nearest to them. A fixed
/// vertex counts 1, a soft one of weight w counts w / (1 + w). One constrained vertex: moved there,
/// neither turned nor scaled. constraints: not empty; with two vertices or more, not all at one
/// place.
Alignment align(std::span<const Vec2> uv, const VertexConstraints& constraints);

/// The map aligned with the constraints, then the hard ones put in their places.
UvMap constrained_start(UvMap uv, const VertexConstraints& constraints);

}  // namespace unwrapd::solve
