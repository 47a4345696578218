#pragma once
// The reference of every measure: each 3D triangle in the plane, isometrically (Sec. 4, Fig. 2).

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::measure {

/// x_t, counter-clockwise in the plane. Corners are numbered as in the face.
struct RestTriangle {
  std::array<Vec2, 3> edge;   ///< edge[i] = x^i - x^{i+1}
  std::array<double, 3> cot;  ///< cotangent of the angle that faces edge[i], at corner i+2
  double area = 0;            ///< A_t > 0
};

/// Heights below this share of the longest edge are raised to it, so that exactly and nearly
/// degenerate triangles keep the matrix of Eq. (4) positive definite and well scaled.
inline constexpr double kMinHeight = 1e-6;

/// One rest triangle a face. Faces must not have all three corners at one point.
/// Throws Error{cancelled}.
std::vector<RestTriangle> flatten(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                  Executor& executor);
std::vector<RestTriangle> flatten(const TriMesh& mesh, const std::stop_token& stop = {});

/// The sum of their areas.
double area_of(std::span<const RestTriangle> rest);

/// 3D area of one face, without the height floor.
double face_area(const TriMesh& mesh, const Triangle& face);

/// Sum of face_area() over all faces. The same bits for any executor.
double surface_area(const TriMesh& mesh, Executor& executor);
double surface_area(const TriMesh& mesh);

}  // namespace unwrapd::measure
