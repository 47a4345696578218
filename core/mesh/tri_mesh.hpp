#pragma once
// The plain types of meshes that all rooms use: points, triangles, surfaces.

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

/// Triangles in space. Faces index positions; lengths are in units of the mesh.
struct TriMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;

  [[nodiscard]] Index vertex_count() const { return static_cast<Index>(positions.size()); }
  [[nodiscard]] Index face_count() const { return static_cast<Index>(faces.size()); }
};

/// One mesh of an asset as it was read, which is unwrapped as a whole and shares texture
/// coordinates. asset::read ensures that every index is in range and every position is finite.
/// Faces may be degenerate, duplicate or non-manifold; core repairs those.
struct Surface {
  TriMesh mesh;
  std::vector<Index> part;  ///< part[t]: the primitive (material) of face t
  std::string name;         ///< JSON pointer of the mesh ("/meshes/0") or the OBJ's "obj"
  std::vector<CornerUv> corner_uv =
      {};  ///< one a face: the UVs of the input, V pointing up; empty
           ///< unless requested and present. NaN for corners without UVs
  std::vector<std::string> materials =
      {};  ///< materials[part[t]] names that of face t; empty unless requested
  /// Painted preferences, one a vertex, in [0, 1]; empty unless requested (ADR 0067).
  std::vector<double> seam_avoid = {};     ///< how dear seams are at the vertex
  std::vector<double> texel_density = {};  ///< how many more texels its surroundings get
  /// Units of the scene in one of the mesh, where the scene shows it largest.
  double scale = 1;
};

/// The result for a surface. Faces keep their number and order; a vertex on a seam is split.
/// source[v] is the input vertex that vertex v copies; the first n entries (n = input vertices) are
/// 0..n-1, split copies follow. uv[v] is in [0,1]^2, V pointing up, unless position constraints put
/// it elsewhere; vertices of no face have uv (0,0).
struct UnwrappedSurface {
  std::vector<Triangle> faces;
  std::vector<Index> source;
  UvMap uv;
};

}  // namespace unwrapd
