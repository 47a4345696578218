#pragma once
// The Jacobian of the map from a rest triangle to its image, split into the part that rotates and
// scales and the part that deforms. Every energy and metric of the paper is a function of the two.
//   J = [e -h; h e] + [f g; g -f],  Q = |(e, h)|,  R = |(f, g)|
//   sigma_max = Q + R,  sigma_min = Q - R (signed),  |J|^2 = 2 Q^2 + 2 R^2,  det J = Q^2 - R^2
// This needs no SVD, and R has no cancellation where the map is conformal.

#include <array>
#include <cmath>
#include <span>

#include "core/measure/rest_triangle.hpp"

namespace unwrapd::measure {

using UvEdges = std::array<Vec2, 3>;  ///< u^i - u^{i+1} of one face

struct Jacobian {
  double e = 0, h = 0;  ///< similarity part: Q (cos, sin) of the anticlockwise rotation
  double f = 0, g = 0;  ///< the remainder: zero where the map is conformal

  [[nodiscard]] double turn_scale() const { return std::sqrt(e * e + h * h); }   ///< Q
  [[nodiscard]] double deformation() const { return std::sqrt(f * f + g * g); }  ///< R
  [[nodiscard]] double sigma_max() const { return turn_scale() + deformation(); }
  [[nodiscard]] double sigma_min() const { return turn_scale() - deformation(); }  ///< < 0: flipped
  [[nodiscard]] double determinant() const { return e * e + h * h - f * f - g * g; }
  [[nodiscard]] double squared_norm() const { return 2 * (e * e + h * h + f * f + g * g); }
};

inline UvEdges uv_edges(const Triangle& face, std::span<const Vec2> uv) {
  const Vec2& a = uv[static_cast<std::size_t>(face[0])];
  const Vec2& b = uv[static_cast<std::size_t>(face[1])];
  const Vec2& c = uv[static_cast<std::size_t>(face[2])];
  return {a - b, b - c, c - a};
}

/// J = [u0 u1] [x0 x1]^-1 of the first two edges; det [x0 x1] = 2 A_t.
inline Jacobian jacobian(const RestTriangle& rest, const UvEdges& u) {
  const Vec2 &x0 = rest.edge[0], &x1 = rest.edge[1];
  const double k = 0.25 / rest.area;
  const double j00 = u[0].x() * x1.y() - u[1].x() * x0.y();
  const double j01 = u[1].x() * x0.x() - u[0].x() * x1.x();
  const double j10 = u[0].y() * x1.y() - u[1].y() * x0.y();
  const double j11 = u[1].y() * x0.x() - u[0].y() * x1.x();
  return {k * (j00 + j11), k * (j10 - j01), k * (j00 - j11), k * (j10 + j01)};
}

/// J x.
inline Vec2 apply(const Jacobian& j, const Vec2& x) {
  return {(j.e + j.f) * x.x() + (j.g - j.h) * x.y(), (j.g + j.h) * x.x() + (j.e - j.f) * x.y()};
}

}  // namespace unwrapd::measure
