// A surface with the geometry of several meshes is shown where all of them are.
#include "core/asset/gltf/scene.hpp"

#include <algorithm>
#include <set>
#include <utility>

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

std::vector<std::optional<Placement>> largest_by_mesh(const Gltf& gltf) {
  const auto meshes = gltf.json.find("meshes");
  std::vector<std::optional<Placement>> largest(meshes == gltf.json.end() ? 0 : meshes->size());
  std::vector<double> area(largest.size());
  for (const MeshNode& node : gltf.mesh_nodes) {
    const double own = node.placement.cofactors().squaredNorm();
    if (largest[node.mesh] && own <= area[node.mesh]) continue;
    largest[node.mesh] = node.placement;
    area[node.mesh] = own;
  }
  return largest;
}

std::vector<std::vector<std::size_t>> meshes_of_surfaces(const Gltf& gltf, std::size_t count) {
  std::vector<std::vector<std::size_t>> meshes(count);
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    std::vector<std::size_t>& own = meshes[gltf.pieces[primitive.piece].surface];
    if (own.empty() || own.back() != primitive.mesh) own.push_back(primitive.mesh);
  }
  return meshes;
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
