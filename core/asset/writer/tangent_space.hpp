#pragma once
// Tangents that follow texture coordinates, compatible with baking and rendering programs
// (MikkTSpace): M. S. Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008, and the
// conventions of its users, which glTF 2.0 names in section 3.7.2.1.

#include <array>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset::writer {

/// Triangles whose corners have a position, a unit normal and texture coordinates, V upwards.
struct TangentMesh {
  std::vector<Vec3> positions, normals;  ///< [vertex]
  std::vector<Vec2> uv;                  ///< [vertex]
  std::vector<Triangle> faces;
};

/// A unit vector along growing U, perpendicular to the normal, and the sign with which the cross
/// product of normal and tangent points along growing V.
using Tangent = std::array<float, 4>;

/// The tangent of every corner. Vertices of equal data count as one. Corners of triangles that
/// share edges there and are not mirrored against each other have the same tangent: that of the
/// triangles, in the plane of the normal, weighted by their angles in that plane. Throws
/// Error{cancelled}.
std::vector<std::array<Tangent, 3>> corner_tangents(const TangentMesh& mesh,
                                                    const std::stop_token& stop);

/// A tangent for a corner whose texture coordinates determine none.
Tangent any_tangent(const Vec3& normal);

}  // namespace unwrapd::asset::writer
