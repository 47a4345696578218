#include "core/asset/gltf/stretched.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/scene.hpp"

namespace unwrapd::asset {
namespace {

constexpr double kMostDistorted = 2.02;  // D_angle, as charts of the preset texture have at most
constexpr std::size_t kMostNamed = 5;

/// D_angle of the placement on the faces, weighted by their area in the scene. With the Gram
/// matrices G of two edges and H of their images, it is tr(G^-1 H) (det G / det H)^(1/2) for a
/// face.
double distortion_of(const Eigen::Matrix3d& linear, const TriMesh& mesh) {
  double sum = 0, areas = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3& at = mesh.positions[as_size(a)];
    const Vec3 e = mesh.positions[as_size(b)] - at, f = mesh.positions[as_size(c)] - at;
    const double area = e.cross(f).norm();
    if (!(area > 0)) continue;
    const Vec3 p = linear * e, q = linear * f;
    sum += (f.dot(f) * p.dot(p) - 2 * e.dot(f) * p.dot(q) + e.dot(e) * q.dot(q)) / area;
    areas += p.cross(q).norm();
  }
  return areas > 0 ? sum / areas : 2;
}

/// The ratio of the two stretches of one map that has this D_angle everywhere.
double ratio_of(double distortion) {
  return (distortion + std::sqrt(std::max(distortion * distortion - 4, 0.0))) / 2;
}

std::string named(const Surface& surface, double distortion) {
  std::array<char, 32> ratio{};
  std::snprintf(ratio.data(), ratio.size(), " (%.3g to 1)", ratio_of(distortion));
  return surface.name + ratio.data();
}

/// D_angle of the placement that shows the surface largest.
double distortion_in_scene(const Surface& surface, std::span<const std::size_t> meshes,
                           std::span<const std::optional<Placement>> largest) {
  const Placement* shown = nullptr;
  for (const std::size_t mesh : meshes)
    if (largest[mesh] && (shown == nullptr || largest[mesh]->cofactors().squaredNorm() >
                                                  shown->cofactors().squaredNorm()))
      shown = &*largest[mesh];
  return shown == nullptr ? 2 : distortion_of(shown->linear, surface.mesh);
}

}  // namespace

std::vector<Note> notes_on_stretched(const Gltf& gltf, std::span<const Surface> surfaces) {
  const auto meshes = meshes_of_surfaces(gltf, surfaces.size());
  const auto largest = largest_by_mesh(gltf);
  std::string names;
  std::size_t count = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const double distortion = distortion_in_scene(surfaces[s], meshes[s], largest);
    if (!(distortion > kMostDistorted)) continue;
    if (++count <= kMostNamed)
      names += (names.empty() ? "" : ", ") + named(surfaces[s], distortion);
  }
  if (count == 0) return {};
  if (count > kMostNamed) names += " and " + std::to_string(count - kMostNamed) + " more";
  return {{NoteCode::nodes_stretch,
           "Nodes make these meshes longer in one direction than in another, and stretch the "
           "texture with them: " +
               names +
               ". Apply the scale of the nodes to the meshes (in Blender: Object, Apply, Scale) "
               "and send the asset again."}};
}

}  // namespace unwrapd::asset
