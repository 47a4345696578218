// How large a scene shows its meshes. The page has texels for what is seen: a mesh of one unit that
// a node makes ten times as large gets ten times the texels along its sides.
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/scene.hpp"
#include "core/asset/reader/steps.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr double kLeastScale = 1e-12;  ///< of a flat mesh that a node shows from its edge, less
constexpr double kRounding = 1e-5;     ///< of scales by products of floats

/// The sum of A_t n n^T over the faces: how much area looks in which direction.
Eigen::Matrix3d areas_by_direction(const TriMesh& mesh) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3& at = mesh.positions[as_size(a)];
    const Vec3 twice = (mesh.positions[as_size(b)] - at).cross(mesh.positions[as_size(c)] - at);
    if (const double length = twice.norm(); length > 0) sum += twice * twice.transpose() / length;
  }
  return sum;
}

/// The root of how many times its area the mesh has in the scene: of the root mean square over its
/// faces, which is exact for one scale in all directions, and for a plane.
std::optional<double> scale_of(const Eigen::Matrix3d& cofactor, const Eigen::Matrix3d& areas) {
  const double ratio = (cofactor * areas * cofactor.transpose()).trace() / areas.trace();
  const double scale = std::sqrt(std::sqrt(ratio));
  if (!(scale >= kLeastScale)) return std::nullopt;
  return std::abs(scale - 1) <= kRounding ? 1 : scale;
}

}  // namespace

void set_scales(const Gltf& gltf, std::vector<Surface>& surfaces) {
  const auto meshes = meshes_of_surfaces(gltf, surfaces.size());
  const auto shown = largest_by_mesh(gltf);
  std::vector<std::optional<double>> scales(surfaces.size());
  std::optional<double> least;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Eigen::Matrix3d areas = areas_by_direction(surfaces[s].mesh);
    for (const std::size_t mesh : meshes[s])
      if (shown[mesh]) scales[s] = std::max(scales[s], scale_of(shown[mesh]->cofactors(), areas));
    if (scales[s]) least = std::min(*scales[s], least.value_or(*scales[s]));
  }
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    surfaces[s].scale = scales[s].value_or(least.value_or(1));
}

}  // namespace unwrapd::asset::reader
