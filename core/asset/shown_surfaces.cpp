// A surface with the geometry of several meshes is shown where all of them are.
#include <algorithm>
#include <set>
#include <utility>

#include "core/asset/document.hpp"

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

std::size_t faces_of(const std::vector<Surface>& surfaces) {
  std::size_t faces = 0;
  for (const Surface& surface : surfaces) faces += surface.mesh.faces.size();
  return faces;
}

/// Whether the scene is nothing but the surfaces, one after another, as they are.
bool is_as_read(const std::vector<ShownSurface>& shown, std::size_t count) {
  if (shown.size() != count) return false;
  for (std::size_t s = 0; s < count; ++s)
    if (shown[s].surface != s || shown[s].placement.linear != Eigen::Matrix3d::Identity() ||
        shown[s].placement.origin != Vec3::Zero())
      return false;
  return true;
}

/// By every node while that makes no more faces than `most`, else by the first of each mesh.
std::vector<ShownSurface> shown_by_nodes(const Gltf& gltf, const std::vector<Surface>& surfaces,
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

}  // namespace

std::vector<ShownSurface> shown_surfaces(const Asset& asset) {
  const Gltf* gltf = std::get_if<Gltf>(&asset.document().source);
  if (gltf == nullptr) return {};
  const std::vector<Surface>& surfaces = asset.document().surfaces;
  const std::size_t most = std::max(kMostShownFaces, 2 * faces_of(surfaces));
  std::vector<ShownSurface> shown = shown_by_nodes(*gltf, surfaces, most);
  if (is_as_read(shown, surfaces.size())) return {};
  return shown;
}

}  // namespace unwrapd::asset
