#pragma once
// Where a scene shows its meshes.

#include <Eigen/Core>

#include <cstddef>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// An affine map from a mesh's own coordinates to those of its scene.
struct Placement {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 origin = Vec3::Zero();

  Vec3 operator()(const Vec3& position) const { return linear * position + origin; }

  /// The cofactors of `linear`: they map the normal of an area, as long as the area, to that of its
  /// image.
  [[nodiscard]] Eigen::Matrix3d cofactors() const;

  [[nodiscard]] bool mirrors() const;
};

/// A surface, by its number, and one of its places.
struct ShownSurface {
  std::size_t surface = 0;
  Placement placement;
};

/// First b, then a.
inline Placement operator*(const Placement& a, const Placement& b) {
  return {a.linear * b.linear, a(b.origin)};
}

}  // namespace unwrapd
