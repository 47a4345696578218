#pragma once
// Mirror symmetry of a surface.

#include <array>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::segment {

/// A reflection that maps a surface onto itself, and its mesh nearly so.
struct Mirror {
  Vec3 centre = Vec3::Zero(), normal = Vec3::UnitX();  ///< of the plane
  std::vector<char> is_front;                          ///< one a face, 1: in front of the plane
  std::vector<Index> halfedge;  ///< one a half-edge: the one from the image of its end to that of
                                ///< its start; -1: the mesh has none there
  std::vector<Index> source;    ///< one a face: behind the plane, the face in front whose image it
                                ///< is, or at whose image it lies; in front -1

  [[nodiscard]] Vec3 reflected(const Vec3& p) const {
    return p - 2 * normal.dot(p - centre) * normal;
  }
};

/// How far a vertex may lie from the image of another one, for a surface of area 1.
inline constexpr double kMirrorTolerance = 1e-3;
/// How many of the vertices have images at least. Faces need none: diagonals of quads may differ.
inline constexpr double kLeastMirrored = 0.95;

/// The mirror of a mesh of area 1: the first that fits of the planes across the axes and across the
/// principal axes, through the centre, along which the mesh can be parted without teeth. Throws
/// Error{cancelled}.
std::optional<Mirror> find_mirror(const TriMesh& mesh, const Halfedges& halfedges,
                                  const std::stop_token& stop = {});

/// The map of a face in front, as its image has it at the corners of a face behind that lies there.
std::array<Vec2, 3> reflected_map(const Mirror& mirror, const TriMesh& mesh,
                                  const std::array<Index, 2>& front_and_behind,
                                  const std::array<Vec2, 3>& uv);

}  // namespace unwrapd::segment
