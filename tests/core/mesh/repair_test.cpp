#include "core/mesh/repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/mesh/weld.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

FaceStates inspected(const TriMesh& mesh) {
  return inspect_faces(mesh, renumber(mesh.faces, weld(mesh.positions)));
}

FaceState state_of_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return inspected({{a, b, c}, {{0, 1, 2}}}).of[0];
}

TEST(Repair, ThreePointsOnALineAreFlatWhereverTheLineIs) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int k = 0; k < 2000; ++k) {
    const double size = std::pow(10.0, 6 * number(rng)), far = std::pow(10.0, 6 * number(rng));
    const Vec3 from = far * Vec3(number(rng), number(rng), number(rng));
    const Vec3 along = size * Vec3(number(rng), number(rng), number(rng));
    const Vec3 a = from, b = from + along, c = from + number(rng) * along;
    if (a == b || b == c || c == a) continue;
    EXPECT_EQ(state_of_triangle(a, b, c), FaceState::flat);
  }
}

TEST(Repair, ASliverOfRealAreaStaysIn) {
  for (double scale : {1e-6, 1.0, 1e6})
    for (double height : {1e-3, 1e-9, 1e-14})
      EXPECT_EQ(state_of_triangle({0, 0, 0}, {scale, 0, 0}, {scale / 3, height * scale, 0}),
                FaceState::sound);
}

TEST(Repair, SizeAloneNeverMakesAFaceDegenerate) {
  for (double scale : {1e-200, 1e-30, 1e30, 1e150})
    EXPECT_EQ(state_of_triangle({0, 0, 0}, {scale, 0, 0}, {0, scale, 0}), FaceState::sound);
}

TEST(Repair, AFaceWhoseAreaUnderflowsBesideTheOthersIsFlat) {
  for (double tiny : {1e-200, 1e-120, 1e-80}) {
    const FaceStates states =
        inspected({{{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {-1, -1, 1}}, {{0, 1, 2}, {1, 0, 3}}});
    EXPECT_EQ(states.of[0], tiny < 1e-90 ? FaceState::flat : FaceState::sound) << tiny;
  }
}

TEST(Repair, TwoCornersAtOnePositionAreACollapsedFace) {
  EXPECT_EQ(state_of_triangle({0, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}), FaceState::collapsed);
  EXPECT_EQ(state_of_triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1}), FaceState::collapsed);
}

TEST(Repair, TheFirstOfEqualFacesIsKeptAndTheOthersPointToIt) {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                     {{1, 2, 0}, {0, 1, 2}, {0, 2, 1}, {2, 0, 3}, {0, 2, 3}}};
  const FaceStates states = inspected(mesh);
  const auto sound = FaceState::sound, duplicate = FaceState::duplicate;
  EXPECT_EQ(states.of, (std::vector<FaceState>{sound, duplicate, sound, duplicate, duplicate}));
  EXPECT_EQ(states.same_as, (std::vector<Index>{kNoFace, 0, kNoFace, 0, 2}));
}

TEST(Repair, SoundMeshesAreLeftAlone) {
  for (const TriMesh& mesh : {shapes::sphere(3), shapes::torus(20, 9), shapes::random_disk(12, 1),
                              shapes::cone(200, 5), shapes::soup(shapes::cube(2))}) {
    const FaceStates states = inspected(mesh);
    EXPECT_EQ(std::count(states.of.begin(), states.of.end(), FaceState::sound), mesh.face_count());
  }
}

}  // namespace
}  // namespace unwrapd
