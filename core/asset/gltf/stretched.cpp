#include "core/asset/gltf/stretched.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/scene.hpp"
#include "core/base/cancel.hpp"
#include "core/types/options.hpp"

namespace unwrapd::asset {
namespace {

constexpr double kLeastShare = 0.05;    // of the area, that must be stretched
constexpr double kLeastSine = 1e-5;     // of a corner's angle; thinner faces are ignored
constexpr double kLeastArea = 1e-9;     // in shares of a face's own; less is seen edge-on
constexpr double kEqualStretch = 1e-6;  // relative, of maps that keep all shapes
constexpr std::size_t kMostNamed = 5;

bool keeps_shapes(const Eigen::Matrix3d& linear) {
  const Eigen::Matrix3d squares = linear.transpose() * linear;
  const double mean = squares.trace() / 3;
  return (squares - mean * Eigen::Matrix3d::Identity()).norm() <= kEqualStretch * mean;
}

/// The area in the scene, and that of stretched faces with the integral of their D_angle.
struct StretchedArea {
  double all = 0, stretched = 0, distortion = 0;
};

/// With the Gram matrices G of two edges and H of their images, D_angle of a face is
/// tr(G^-1 H) (det G / det H)^(1/2).
void add_face(const Vec3& e, const Vec3& f, const Eigen::Matrix3d& linear, StretchedArea& area) {
  const double own = e.cross(f).norm();
  if (!(own > kLeastSine * e.norm() * f.norm())) return;
  const Vec3 p = linear * e, q = linear * f;
  const double shown = p.cross(q).norm();
  area.all += shown;
  if (!(shown > kLeastArea * linear.squaredNorm() * own)) return;
  const double trace = f.dot(f) * p.dot(p) - 2 * e.dot(f) * p.dot(q) + e.dot(e) * q.dot(q);
  if (!(trace > kDefaultDistortion * own * shown)) return;
  area.stretched += shown;
  area.distortion += trace / own;
}

/// How many times longer the stretched faces are in one direction; 1 where there are too few.
double stretch_of(const Eigen::Matrix3d& linear, const TriMesh& mesh, const std::stop_token& stop) {
  if (keeps_shapes(linear)) return 1;
  StretchedArea area;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    check_cancelled_every(t, stop);
    const auto& [a, b, c] = mesh.faces[t];
    const Vec3& at = mesh.positions[as_size(a)];
    add_face(mesh.positions[as_size(b)] - at, mesh.positions[as_size(c)] - at, linear, area);
  }
  if (!(area.stretched > kLeastShare * area.all)) return 1;
  const double mean = area.distortion / area.stretched;  // r + 1 / r
  return (mean + std::sqrt(std::max(mean * mean - 4, 0.0))) / 2;
}

std::string named(const Surface& surface, double stretch) {
  std::array<char, 32> ratio{};
  std::snprintf(ratio.data(), ratio.size(), " (%.3g to 1)", stretch);
  return surface.name + ratio.data();
}

}  // namespace

std::vector<Note> notes_on_stretched(const Gltf& gltf, std::span<const Surface> surfaces) {
  const std::vector<std::optional<ScaledPlacement>> shown = largest_shown(gltf, surfaces);
  std::string names;
  std::size_t count = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (!shown[s]) continue;
    const double stretch = stretch_of(shown[s]->placement.linear, surfaces[s].mesh, gltf.stop);
    if (stretch == 1 || ++count > kMostNamed) continue;
    names += (names.empty() ? "" : ", ") + named(surfaces[s], stretch);
  }
  if (count == 0) return {};
  if (count > kMostNamed) names += " and " + std::to_string(count - kMostNamed) + " more";
  return {{NoteCode::nodes_stretch,
           "Nodes scale these meshes unevenly, which stretches their textures: " + names +
               ". Apply the scale of the nodes to the meshes (in Blender: Object, Apply, Scale) "
               "and send the asset again."}};
}

}  // namespace unwrapd::asset
