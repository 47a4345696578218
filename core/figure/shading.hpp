#pragma once
// The colour of a place on a surface: a checkerboard under two lamps.

#include <array>

#include "core/figure/image.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// What the colours of a face depend on, at its corners.
struct FaceLook {
  std::array<Vec3, 3> normal;  ///< x to the right, y up, z toward the one who looks
  std::array<Vec2, 3> uv;
  bool is_inside = false;  ///< the inner side of the face is seen
};

/// The vertex's normal, unless an edge of the surface is so sharp there that the face's own (a unit
/// vector, or zero) must count.
Vec3 corner_normal(const Vec3& face, const Vec3& vertex);

/// The colours of both kinds of squares where the corners have these weights.
struct Lit {
  Rgb light, dark;
};
Lit lit(const FaceLook& look, const std::array<double, 3>& weight);

/// Whether there is a dark square of the board; `checks` squares lie along the page's side.
bool is_dark(const FaceLook& look, const std::array<double, 3>& weight, double checks);

}  // namespace unwrapd::figure
