// From where a mesh is seen: by name, by angles, and all around.
#include "core/figure/view.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <random>

#include "core/figure/colour_scale.hpp"
#include "core/figure/preview.hpp"
#include "tests/core/figure/laid_out.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::figure {
namespace {

using namespace shapes;

/// Rows of a square part of a picture in which something is drawn: first and last.
std::pair<int, int> drawn_rows(const Image& image, int left, int top, int side) {
  std::pair<int, int> rows = {side, -1};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (image.at(left + x, top + y) != kPaper) rows = {std::min(rows.first, y), y};
  return rows;
}

TEST(Aspect, NamesAreTheSidesOfAGltf) {
  struct Named {
    const char* name;
    Vec3 toward, up;
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const TriMesh mesh = grid(2, 2);
  const Surface surface = surface_of(mesh);
  for (const auto& [name, toward, up] :
       {Named{"front", z, y}, Named{"back", -z, y}, Named{"right", x, y}, Named{"left", -x, y},
        Named{"top", y, -z}, Named{"bottom", -y, z}}) {
    const View view = view_of({&surface, 1}, 100, aspect_named(name));
    EXPECT_LT((view.toward - toward).norm(), 1e-12) << name;
    EXPECT_LT((view.up - up).norm(), 1e-12) << name;
  }
  EXPECT_FALSE(aspect_named("auto"));
  EXPECT_FALSE(aspect_named(""));
}

TEST(Aspect, AnyAnglesGiveAnOrthonormalViewWithUpUp) {
  const TriMesh mesh = sphere_cap(6, 3);
  const Surface surface = surface_of(mesh);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> azimuth(-360, 360), elevation(-90, 90);
  for (int k = 0; k < 200; ++k) {
    const Aspect aspect{azimuth(random), k % 3 == 0 ? (k % 2 == 0 ? 90 : -90) : elevation(random)};
    const View view = view_of({&surface, 1}, 100, aspect);
    EXPECT_LT((view.right.cross(view.up) - view.toward).norm(), 1e-12);
    EXPECT_NEAR(view.right.norm(), 1, 1e-12);
    EXPECT_NEAR(view.right.y(), 0, 1e-12) << "the horizon is level";
    EXPECT_GE(view.up.y(), -1e-12);
    for (const Vec3& p : mesh.positions) {
      const Vec2 pixel = view.pixel(p);
      EXPECT_TRUE(pixel.minCoeff() > 0 && pixel.maxCoeff() < 100);
    }
  }
}

TEST(Preview, ShowsTheSideThatIsAskedFor) {
  const TriMesh mesh = grid(3, 3);  // in the plane z = 0, its outer side towards +Z
  const Surface surface = surface_of(mesh);
  const UnwrappedSurface out = by_xy(mesh);
  const auto brightness = [&](const char* name) {
    const Image image = preview({&surface, 1}, {&out, 1}, 128, aspect_named(name));
    long sum = 0;
    for (int y = 40; y < 88; ++y)
      for (int x = 40; x < 88; ++x) sum += image.at(x, y)[0];
    return sum;
  };
  EXPECT_LT(brightness("back"), 0.9 * static_cast<double>(brightness("front")))
      << "an inner side is darker";
  const Image edge_on = preview({&surface, 1}, {&out, 1}, 128, aspect_named("right"));
  EXPECT_EQ(edge_on.at(30, 64), kPaper) << "a plane from aside is a line";
}

TEST(Turntable, HasEightViewsAtOneScale) {
  const TriMesh mesh = cube();
  const Surface surface = surface_of(mesh);
  const UnwrappedSurface out = by_xy(mesh);
  const Image sheet = turntable({&surface, 1}, {&out, 1}, 514);
  EXPECT_EQ(sheet.width, 512);
  EXPECT_EQ(sheet.height, 256);
  const auto rows_of_view = [&](int k) {
    return drawn_rows(sheet, 128 * (k % 4), 128 * (k / 4), 128);
  };
  for (int k = 0; k < kTurntableViews; ++k) {
    const auto [first, last] = rows_of_view(k);
    EXPECT_GT(last - first, 40) << k;
    EXPECT_EQ(rows_of_view(k), rows_of_view((k + 2) % kTurntableViews)) << "a quarter turn on";
  }
  EXPECT_NE(rows_of_view(0), rows_of_view(1)) << "the corner is nearer";
}

}  // namespace
}  // namespace unwrapd::figure
