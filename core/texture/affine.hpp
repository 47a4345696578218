#pragma once
// The affine map of a triangle from the new layout to the old one.

#include <Eigen/Core>
#include <Eigen/LU>

#include <optional>

#include "core/texture/resample.hpp"

namespace unwrapd::texture {

using Mat2 = Eigen::Matrix2d;

struct Affine {
  Vec2 origin;       ///< corner 0 in the new layout
  Mat2 barycentric;  ///< of the offset from origin: the weights of corners 1 and 2
  Vec2 start;        ///< corner 0 in the old layout
  Mat2 linear;       ///< of the offset from origin, to that from start
};

inline Vec2 in_texels(const Eigen::Vector2f& place, const Size& page) {
  return place.cast<double>().cwiseProduct(Vec2(page.width, page.height));
}

/// page: of the new layout, whose texels are the unit of length there. Empty if the triangle has no
/// area in the new layout, or is not finite.
inline std::optional<Affine> affine_of(const PlacedTriangle& triangle, const Size& page) {
  const auto to = [&](std::size_t k) { return in_texels(triangle.to[k], page); };
  const auto from = [&](std::size_t k) { return Vec2(triangle.from[k].cast<double>()); };
  Mat2 edges, old;
  edges << to(1) - to(0), to(2) - to(0);
  old << from(1) - from(0), from(2) - from(0);
  if (!(std::abs(edges.determinant()) > 0) || !old.allFinite() || !from(0).allFinite())
    return std::nullopt;
  const Mat2 inverse = edges.inverse();
  if (!inverse.allFinite()) return std::nullopt;
  return Affine{to(0), inverse, from(0), old * inverse};
}

}  // namespace unwrapd::texture
