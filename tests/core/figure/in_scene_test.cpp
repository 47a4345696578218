// Surfaces where a scene shows them, beside the same meshes placed by hand.
#include "core/figure/in_scene.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/figure/painting.hpp"
#include "core/figure/preview.hpp"
#include "tests/core/figure/laid_out.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::figure {
namespace {

using namespace shapes;

/// Of a closed surface; positive if its faces' outer sides are outside.
double volume(const TriMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.faces)
    six += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c]));
  return six / 6;
}

Placement scaled(const Vec3& by, const Vec3& to = Vec3::Zero()) {
  return {Eigen::Matrix3d(by.asDiagonal()), to};
}

TEST(InScene, OuterSidesStayOutsideWherePlacementsMirror) {
  const Surface box = surface_of(cube(1));
  const UnwrappedSurface out = by_xy(box.mesh, 0.1);
  const std::vector<ShownSurface> shown = {{0, scaled({2, 3, 4}, {9, 9, 9})},
                                           {0, scaled({-2, 3, 4}, {9, 9, 9})},
                                           {0, scaled({-2, -3, 4})}};
  const Scene scene = in_scene({&box, 1}, {&out, 1}, shown);
  ASSERT_EQ(scene.surfaces.size(), 3U);
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_NEAR(volume(scene.surfaces[s].mesh), 24 * volume(box.mesh), 1e-9);
    EXPECT_EQ(scene.surfaces[s].mesh.faces, scene.unwrapped[s].faces);
  }
}

TEST(InScene, LooksLikeTheMeshesPlacedByHand) {
  const Surface box = surface_of(cube(1)), sheet = surface_of(grid(2, 2));
  const std::vector<Surface> given = {box, sheet};
  const std::vector<UnwrappedSurface> out = {by_xy(box.mesh, 0.1), by_xy(sheet.mesh, 0.1)};
  const std::vector<ShownSurface> shown = {
      {1, scaled({4, 4, 4})}, {0, {}}, {0, scaled({1, 1, 1}, {2, 0, 1})}};
  TriMesh large = sheet.mesh;
  for (Vec3& p : large.positions) p *= 4;
  const std::vector<Surface> by_hand = {surface_of(large), box,
                                        surface_of(moved(box.mesh, {2, 0, 1}))};
  const std::vector<UnwrappedSurface> out_by_hand = {out[1], out[0], out[0]};
  const Scene scene = in_scene(given, out, shown);
  EXPECT_EQ(preview(scene.surfaces, scene.unwrapped, 256).rgb,
            preview(by_hand, out_by_hand, 256).rgb);
}

TEST(InScene, LeavesOutWhatLiesBeyondAllNumbers) {
  const Surface box = surface_of(cube(1));
  const UnwrappedSurface out = by_xy(box.mesh, 0.1);
  const Vec3 far = Vec3::Constant(1.7e308);
  const std::vector<ShownSurface> shown = {{0, scaled(far, far)}, {0, {}}};
  EXPECT_EQ(in_scene({&box, 1}, {&out, 1}, shown).surfaces.size(), 1U);
}

TEST(PaintedFaces, CompareLengthsInTheScene) {
  const TriMesh mesh = grid(1, 1);
  std::vector<Surface> surfaces = {surface_of(mesh), surface_of(mesh)};
  std::vector<UnwrappedSurface> out = {by_xy(mesh, 0.1), by_xy(mesh, 0.1)};
  for (Vec2& uv : out[1].uv) uv *= 8;
  const std::vector<std::uint8_t> even(2, 0);
  EXPECT_NE(painted_faces(surfaces, out, Colouring::stretch)[0], even);
  surfaces[1].scale = 8;
  for (const auto& painted : painted_faces(surfaces, out, Colouring::stretch))
    EXPECT_EQ(painted, even);
}

}  // namespace
}  // namespace unwrapd::figure
