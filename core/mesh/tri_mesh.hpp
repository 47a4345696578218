#pragma once
// The plain types that every part of the project speaks: points, triangles, surfaces.

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace unwrapd {

using Index = std::int32_t;
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Triangle = std::array<Index, 3>;  ///< vertex indices, counter-clockwise
using UvMap = std::vector<Vec2>;        ///< one UV a vertex
using CornerUv = std::array<Vec2, 3>;   ///< the UVs of a face's corners

/// Triangles in space. Faces index positions; lengths are in the asset's own (mesh) units.
struct TriMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;

  [[nodiscard]] Index vertex_count() const { return static_cast<Index>(positions.size()); }
  [[nodiscard]] Index face_count() const { return static_cast<Index>(faces.size()); }
};

/// One mesh of an asset, as read: what is unwrapped together and shares texture coordinates.
/// Invariants kept by asset::read: every index is in range, every position is finite. Faces may
/// still be degenerate, duplicate, non-manifold: core repairs those.
struct Surface {
  TriMesh mesh;
  std::vector<Index> part;  ///< part[t]: the primitive (material) that face t came from
  std::string name;         ///< JSON pointer of the mesh ("/meshes/0") or the OBJ's "obj"
  std::vector<CornerUv> corner_uv = {};  ///< one a face: the UVs that came in, V pointing up; empty
                                         ///< unless asked for and there. Corners without are NaN
};

/// A surface's answer. Faces keep their number and order; a vertex that lies on a seam is split.
/// source[v] is the input vertex that vertex v copies; the first n entries (n = input vertices) are
/// 0..n-1, split copies follow. uv[v] is in [0,1]^2, V pointing up, unless position constraints put
/// it elsewhere; vertices that no face uses have uv (0,0).
struct UnwrappedSurface {
  std::vector<Triangle> faces;
  std::vector<Index> source;
  UvMap uv;
};

}  // namespace unwrapd
