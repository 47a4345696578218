// A surface with the geometry of several meshes is shown where all of them are.
#include "core/asset/gltf/scene.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/asset/base/as_size.hpp"

namespace unwrapd::asset {
namespace {

/// surfaces[mesh]: those with faces of the mesh, ascending.
std::vector<std::set<std::size_t>> surfaces_of_meshes(const Gltf& gltf) {
  std::vector<std::set<std::size_t>> surfaces;
  for (const Primitive& primitive : gltf.primitives) {
    surfaces.resize(std::max(surfaces.size(), primitive.mesh + 1));
    if (primitive.has_triangles)
      surfaces[primitive.mesh].insert(gltf.pieces[primitive.piece].surface);
  }
  return surfaces;
}

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

/// See ScaledPlacement.
double area_ratio(const Placement& placement, const Eigen::Matrix3d& areas) {
  const Eigen::Matrix3d cofactor = placement.cofactors();
  return std::sqrt((cofactor * areas * cofactor.transpose()).trace() / areas.trace());
}

/// A ratio of an area of 0 is no number, and larger than none.
void keep_larger(const ScaledPlacement& own, std::optional<ScaledPlacement>& largest) {
  if (own.area_ratio > (largest ? largest->area_ratio : -1.0)) largest = own;
}

}  // namespace

std::vector<ShownSurface> shown_by_nodes(const Gltf& gltf, std::span<const Surface> surfaces,
                                         std::size_t most) {
  const auto of_mesh = surfaces_of_meshes(gltf);
  std::vector<ShownSurface> all, once;
  std::vector<char> is_mesh_shown(of_mesh.size()), is_shown(surfaces.size());
  std::size_t faces = 0;
  for (const auto& [mesh, placement] : gltf.mesh_nodes) {
    if (mesh >= of_mesh.size()) continue;
    if (std::exchange(is_mesh_shown[mesh], 1) != 0 && faces > most) continue;
    for (const std::size_t s : of_mesh[mesh]) {
      if (std::exchange(is_shown[s], 1) == 0) once.push_back({s, placement});
      if (faces <= most) all.push_back({s, placement});
      faces += surfaces[s].mesh.faces.size();
    }
  }
  return faces > most ? once : all;
}

std::vector<Placement> first_placements(const Gltf& gltf, std::span<const Surface> surfaces) {
  std::vector<Placement> placements(surfaces.size());
  for (const auto& [surface, placement] : shown_by_nodes(gltf, surfaces, 0))
    placements[surface] = placement;
  return placements;
}

std::vector<std::optional<ScaledPlacement>> largest_shown(const Gltf& gltf,
                                                          std::span<const Surface> surfaces) {
  const auto of_mesh = surfaces_of_meshes(gltf);
  std::vector<Eigen::Matrix3d> areas;
  for (const Surface& surface : surfaces) areas.push_back(areas_by_direction(surface.mesh));
  std::vector<Eigen::Matrix3d> areas_of_mesh(of_mesh.size(), Eigen::Matrix3d::Zero());
  for (std::size_t mesh = 0; mesh < of_mesh.size(); ++mesh)
    for (const std::size_t s : of_mesh[mesh]) areas_of_mesh[mesh] += areas[s];
  std::vector<std::optional<ScaledPlacement>> by_mesh(of_mesh.size()), largest(surfaces.size());
  for (const auto& [mesh, placement] : gltf.mesh_nodes)
    if (mesh < of_mesh.size())
      keep_larger({placement, area_ratio(placement, areas_of_mesh[mesh])}, by_mesh[mesh]);
  for (std::size_t mesh = 0; mesh < of_mesh.size(); ++mesh) {
    if (!by_mesh[mesh]) continue;
    const Placement& placement = by_mesh[mesh]->placement;
    for (const std::size_t s : of_mesh[mesh])
      keep_larger({placement, area_ratio(placement, areas[s])}, largest[s]);
  }
  return largest;
}

std::size_t repeated_nodes(const Gltf& gltf) {
  const auto of_mesh = surfaces_of_meshes(gltf);
  std::set<std::size_t> meshes, surfaces;
  std::size_t repeated = 0;
  for (const MeshNode& node : gltf.mesh_nodes) {
    if (node.mesh >= of_mesh.size() || of_mesh[node.mesh].empty()) continue;
    bool is_new = false;
    if (meshes.insert(node.mesh).second)
      for (const std::size_t s : of_mesh[node.mesh]) is_new |= surfaces.insert(s).second;
    repeated += is_new ? 0 : 1;
  }
  return repeated;
}

}  // namespace unwrapd::asset
