// The textured mesh: colours at known places, depth, seams, and that nothing breaks it.
#include "core/figure/preview.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <limits>

#include "core/figure/colour_scale.hpp"
#include "core/figure/seam_lines.hpp"
#include "core/figure/view.hpp"
#include "tests/core/figure/laid_out.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::figure {
namespace {

using namespace shapes;

Image picture(const TriMesh& mesh, const UnwrappedSurface& out, int size = 256) {
  const Surface surface = surface_of(mesh);
  return preview({&surface, 1}, {&out, 1}, size);
}

Rgb colour_at(const Image& image, const View& view, const Vec3& position) {
  const Vec2 pixel = view.pixel(position);
  return image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
}

bool is_light(const Rgb& colour) { return colour[0] > colour[2] - 30; }
bool is_pink(const Rgb& c) { return c[0] > 200 && c[1] < 120 && c[2] > 80; }

long count_of(const Image& image, bool (*test)(const Rgb&)) {
  long count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) count += test(image.at(x, y)) ? 1 : 0;
  return count;
}

TEST(Preview, APlaneHasItsSquaresWhereTheUvsSay) {
  const TriMesh mesh = grid(3, 3);
  const Surface surface = surface_of(mesh);
  const View view = view_of({&surface, 1}, 512);
  const Image image = picture(mesh, by_xy(mesh), 512);
  // Looked at from aside, the square's diagonal is what fills the picture: count the squares.
  const double checks = std::round(kChecksAcross / (view.extent / view.pixels));
  for (int j = 1; j < 20; ++j) {
    for (int i = 1; i < 20; ++i) {
      const Vec3 middle((i + 0.5) / checks, (j + 0.5) / checks, 0);
      EXPECT_EQ(is_light(colour_at(image, view, middle)), (i + j) % 2 == 0) << i << " " << j;
    }
  }
}

TEST(Preview, WhatIsNotCoveredIsWhite) {
  const TriMesh mesh = grid(2, 2);
  const Image image = picture(mesh, by_xy(mesh));
  for (const auto& [x, y] : {std::array{0, 0}, {255, 0}, {0, 255}, {255, 255}})
    EXPECT_EQ(image.at(x, y), kPaper);
  EXPECT_LT(count_of(image, [](const Rgb& c) { return c == kPaper; }), 256 * 256 * 3 / 4);
}

TEST(Preview, WhatIsNearerHidesTheRestInWhateverOrder) {
  const TriMesh far = grid(4, 4), near = moved(grid(1, 1, 0.4, 0.4), {0.3, 0.3, 0.2});
  const Vec3 middle(0.5, 0.5, 0.2);
  for (const bool near_first : {false, true}) {
    const TriMesh mesh = near_first ? merged(std::array{near, far}) : merged(std::array{far, near});
    const auto uv = [](const Vec3& p) {  // the near one lies in one dark square
      return p.z() > 0 ? Vec2(0.001 * p.x(), 0.001 * p.y() + 0.01) : Vec2(2 * p.x(), 2 * p.y());
    };
    const Surface surface = surface_of(mesh);
    const View view = view_of({&surface, 1}, 256);
    const UnwrappedSurface out = laid_out(mesh, uv);
    const Image image = picture(mesh, out);
    const Rgb hit = colour_at(image, view, middle);
    for (double step = -0.1; step <= 0.1; step += 0.05)
      EXPECT_EQ(colour_at(image, view, middle + Vec3(step, step, 0)), hit) << near_first;
  }
}

TEST(Preview, ASeamIsPinkAndABoundaryIsNot) {
  const TriMesh mesh = soup(grid(2, 1));
  const UnwrappedSurface whole = by_xy(mesh, 0.4);
  EXPECT_EQ(count_of(picture(mesh, whole), is_pink), 0);
  UnwrappedSurface cut = whole;
  for (std::size_t t = 2; t < 4; ++t)
    for (const Index v : cut.faces[t]) cut.uv[v] += Vec2(0.3, 0.1);
  EXPECT_GT(count_of(picture(mesh, cut), is_pink), 50);
}

TEST(SeamLines, TellBothSidesOfASeamAndEachBoundaryOnce) {
  const TriMesh mesh = soup(grid(2, 1));
  UnwrappedSurface cut = by_xy(mesh, 0.4);
  for (std::size_t t = 2; t < 4; ++t)
    for (const Index v : cut.faces[t]) cut.uv[v] += Vec2(0.3, 0.1);
  long seams = 0, boundaries = 0;
  for (const SeamLine& line : seam_lines(surface_of(mesh), cut)) {
    ++(line.is_seam ? seams : boundaries);
    const double x = mesh.positions[cut.source[line.edge[0]]].x();
    EXPECT_TRUE(!line.is_seam || x == 0.5);
  }
  EXPECT_EQ(seams, 2);
  EXPECT_EQ(boundaries, 6);
}

TEST(Preview, TheInnerSideIsDarker) {
  TriMesh mesh = grid(1, 1);
  const Image outside = picture(mesh, by_xy(mesh, 0.001));
  TriMesh box = merged(std::array{mesh, moved(mesh, {0, 0, -3}), moved(mesh, {0, 0, -6})});
  std::swap(box.faces[0][0], box.faces[0][1]);
  std::swap(box.faces[1][0], box.faces[1][1]);
  const Surface surface = surface_of(box);
  const View view = view_of({&surface, 1}, 256);
  const Image turned = picture(box, by_xy(box, 0.001));
  const int inside = colour_at(turned, view, {0.3, 0.6, 0})[1];
  EXPECT_LT(inside, outside.at(128, 128)[1] - 30);
}

TEST(Preview, TheSameMeshGivesTheSameBytesAndSizeDoesNotChangeTheView) {
  const TriMesh mesh = sphere_cap(40, 20, 2);
  const UnwrappedSurface out = by_xy(mesh, 0.5);
  const Image once = picture(mesh, out, 128);
  EXPECT_EQ(once.rgb, picture(mesh, out, 128).rgb);
  const Image larger = picture(mesh, out, 256);
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (const std::uint8_t part : image.rgb) sum += part;
    return sum / static_cast<double>(image.rgb.size());
  };
  EXPECT_NEAR(mean(once), mean(larger), 1);
}

TEST(Preview, ScaleAndPlaceOfTheMeshDoNotMatter) {
  const TriMesh mesh = sphere_cap(24, 12, 2);
  const UnwrappedSurface out = by_xy(mesh, 0.5);
  const Image usual = picture(mesh, out);
  for (const double scale : {0x1p-100, 0x1p100}) {
    TriMesh scaled = mesh;
    for (Vec3& p : scaled.positions) p *= scale;
    EXPECT_EQ(picture(scaled, out).rgb, usual.rgb) << scale;
  }
}

TEST(Preview, NothingBreaksIt) {
  EXPECT_EQ(preview({}, {}, kMinImageSize).at(32, 32), kPaper);
  const double huge = std::numeric_limits<double>::max(), tiny = 5e-324;
  for (const TriMesh& mesh :
       {TriMesh{}, TriMesh{{{1, 2, 3}}, {{0, 0, 0}}},
        TriMesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}},
        TriMesh{{{-huge, 0, 0}, {huge, huge, 0}, {0, -huge, huge}}, {{0, 1, 2}}},
        TriMesh{{{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}}, {{0, 1, 2}}},
        TriMesh{{{1e9, 0, 0}, {1e9 + 1, 0, 0}, {1e9, 1, 0}, {5, 5, huge}}, {{0, 1, 2}}}}) {
    for (const double uv : {0.0, 1.0, 1e300})
      EXPECT_EQ(
          picture(mesh, laid_out(mesh, [&](const Vec3&) { return Vec2(uv, -uv); })).rgb.size(),
          3U * 256 * 256);
  }
}

TEST(View, FitsIntoThePictureAndKeepsProportions) {
  for (const TriMesh& mesh :
       {grid(3, 2, 7, 1), torus(20, 10), moved(sphere_cap(12, 6), {50, 9, 3})}) {
    const Surface surface = surface_of(mesh);
    const View view = view_of({&surface, 1}, 1000);
    Vec2 low(1e9, 1e9), high(-1e9, -1e9);
    for (const Vec3& p : mesh.positions) {
      low = low.cwiseMin(view.pixel(p));
      high = high.cwiseMax(view.pixel(p));
    }
    EXPECT_GE(low.minCoeff(), 39.9);
    EXPECT_LE(high.maxCoeff(), 960.1);
    EXPECT_NEAR((high - low).maxCoeff(), 920, 1e-6);
    EXPECT_NEAR(view.right.cross(view.up).dot(view.toward), 1, 1e-12);
    EXPECT_GT(view.up.y(), 0);
  }
}

TEST(View, LooksAtTheOuterSideOfAnOpenSurface) {
  TriMesh mesh = sphere_cap(24, 12, 1);
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
    TriMesh turned = mesh;
    const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Vec3(0, 0, 1), axis);
    for (Vec3& p : turned.positions) p = q * p;
    const Surface surface = surface_of(turned);
    EXPECT_GT(view_of({&surface, 1}, 100).toward.dot(axis), 0.5) << axis.transpose();
  }
}

}  // namespace
}  // namespace unwrapd::figure
