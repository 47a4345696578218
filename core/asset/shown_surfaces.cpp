#include <algorithm>

#include "core/asset/document.hpp"
#include "core/asset/gltf/scene.hpp"

namespace unwrapd::asset {
namespace {

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
