#include "core/figure/in_scene.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::figure {
namespace {

TriMesh placed(TriMesh mesh, const Placement& placement) {
  for (Vec3& position : mesh.positions) position = placement(position);
  return mesh;
}

void turn_winding(std::vector<Triangle>& faces) {
  for (Triangle& face : faces) std::swap(face[1], face[2]);
}

}  // namespace

Scene in_scene(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
               std::span<const ShownSurface> shown) {
  Scene scene;
  for (const auto& [s, placement] : shown) {
    TriMesh mesh = placed(surfaces[s].mesh, placement);
    if (!std::ranges::all_of(mesh.positions, [](const Vec3& p) { return p.allFinite(); })) continue;
    scene.surfaces.emplace_back().mesh = std::move(mesh);
    scene.unwrapped.push_back(unwrapped[s]);
    if (!placement.mirrors()) continue;
    turn_winding(scene.surfaces.back().mesh.faces);
    turn_winding(scene.unwrapped.back().faces);
  }
  return scene;
}

}  // namespace unwrapd::figure
