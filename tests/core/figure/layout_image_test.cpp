// The layout in pixels: the same faces in the same colours as in the SVG, legend included.
#include "core/figure/layout_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stop_token>
#include <vector>

#include "core/figure/legend.hpp"
#include "core/figure/painting.hpp"
#include "core/figure/preview.hpp"
#include "core/figure/raster.hpp"
#include "tests/api/error_of.hpp"
#include "tests/core/figure/laid_out.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::figure {
namespace {

using namespace shapes;

constexpr int kSize = 256;

UnwrappedSurface flattened(const TriMesh& mesh, const Vec2& scale) {
  return laid_out(mesh, [&](const Vec3& p) { return Vec2(p.head<2>().cwiseProduct(scale)); });
}

Image picture(const TriMesh& mesh, const UnwrappedSurface& out,
              Colouring colouring = Colouring::stretch) {
  const Surface surface = surface_of(mesh);
  return layout_image({&surface, 1}, {&out, 1}, colouring, kSize);
}

/// The colour at a UV.
Rgb at(const Image& image, double u, double v) {
  return image.at(static_cast<int>(u * kSize), static_cast<int>((1 - v) * kSize));
}

long count_of(const Image& image, const Rgb& colour) {
  long count = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) count += image.at(x, y) == colour ? 1 : 0;
  return count;
}

TEST(LayoutImage, ALineLiesBetweenTwoPages) {
  const TriMesh mesh = merged(std::array{grid(1, 1), moved(grid(1, 1), {1.4, 0, 0})});
  const UnwrappedSurface out = flattened(mesh, {0.8, 0.8});
  const Surface surface = surface_of(mesh);
  LayoutLook look;
  look.page_count = 2;
  const Image image = layout_image({&surface, 1}, {&out, 1}, look, kSize);
  EXPECT_NE(at(image, 0.5, 0.7), kPage);
  look.page_count = 1;
  const Image plain = layout_image({&surface, 1}, {&out, 1}, look, kSize);
  EXPECT_EQ(at(plain, 0.5, 0.7), kPage);
}

TEST(LayoutImage, VPointsUpAndTheIslandHasItsArea) {
  const TriMesh mesh = grid(5, 5);
  const Image image = picture(mesh, flattened(mesh, {0.5, 0.25}));
  EXPECT_EQ(image.width, kSize);
  EXPECT_EQ(image.height, kSize + 20);  // 320/4096 of the side below
  EXPECT_EQ(at(image, 0.6, 0.1), kPage);
  EXPECT_EQ(at(image, 0.1, 0.9), kPage);
  EXPECT_NE(at(image, 0.1, 0.1), kPage);
  const long covered = kSize * kSize - count_of(image, kPage);
  EXPECT_NEAR(static_cast<double>(covered), 128 * 64, 400);  // half a line more on each side
}

TEST(LayoutImage, FacesHaveTheColourOfTheirFigure) {
  const TriMesh mesh = grid(4, 4);
  const UnwrappedSurface out = flattened(mesh, {0.8, 0.2});  // sigma 2 and 1/2 after scaling
  const auto colour = [](Colouring colouring, double value) {
    const ColourScale& scale = colour_scale(colouring);
    return scale.colours[scale.colour_of(value)];
  };
  EXPECT_EQ(at(picture(mesh, out, Colouring::stretch), 0.31, 0.11), colour(Colouring::stretch, 2));
  EXPECT_EQ(at(picture(mesh, out, Colouring::angle), 0.31, 0.11), colour(Colouring::angle, 4.01));
  EXPECT_EQ(at(picture(mesh, out, Colouring::area), 0.31, 0.11), colour(Colouring::area, 1));
  EXPECT_EQ(at(picture(mesh, out, Colouring::flips), 0.31, 0.11), colour(Colouring::flips, 1));
}

TEST(LayoutImage, AreasErrBothWays) {
  const TriMesh mesh = merged(std::array{grid(1, 1), moved(grid(1, 1), {2, 0, 0})});
  UnwrappedSurface out = flattened(mesh, {0.1, 0.1});
  for (std::size_t v = 4; v < 8; ++v) out.uv[v] = Vec2(0.2, 0) + 3 * (out.uv[v] - Vec2(0.2, 0));
  const auto painted = [&](Colouring colouring) {
    const Surface surface = surface_of(mesh);
    return painted_faces({&surface, 1}, {&out, 1}, colouring)[0];
  };
  const std::vector<std::uint8_t> faces = painted(Colouring::area);  // areas 1/5 and 9/5
  EXPECT_EQ(faces[0], 0);
  EXPECT_EQ(faces[2], colour_scale(Colouring::area).colour_of(1.8));
  EXPECT_EQ(painted(Colouring::angle), std::vector<std::uint8_t>(4, 0));
}

TEST(LayoutImage, AFlipShowsHoweverSmallItIs) {
  const TriMesh mesh = grid(100, 100);
  UnwrappedSurface out = flattened(mesh, {0.9, 0.9});
  EXPECT_EQ(count_of(picture(mesh, out, Colouring::flips), kFlippedColour), 0);
  std::swap(out.faces[777][0], out.faces[777][1]);
  EXPECT_GE(count_of(picture(mesh, out, Colouring::flips), kFlippedColour), 3);
}

/// Two squares of side .5, the second one moved.
UnwrappedSurface two_squares(const TriMesh& mesh, const Vec2& second) {
  UnwrappedSurface out = flattened(mesh, {0.5, 0.5});
  for (std::size_t v = 0; v < out.uv.size(); ++v) {
    if (v < out.uv.size() / 2)
      out.uv[v] += Vec2(0.05, 0.05);
    else
      out.uv[v] += second - Vec2(1, 0);
  }
  return out;
}

TEST(LayoutImage, OnlyPlacesThatTwoTrianglesShareAreHatched) {
  const TriMesh mesh = merged(std::array{grid(7, 7), moved(grid(7, 7), {2, 0, 0})});
  const auto beside = [&](double u) { return picture(mesh, two_squares(mesh, {u, 0.05})); };
  EXPECT_EQ(count_of(beside(0.05 + 0.5), kOverlapColour), 0);  // they touch
  const Image both = picture(mesh, two_squares(mesh, {0.35, 0.35}));
  const Image one = picture(grid(7, 7), flattened(grid(7, 7), {0.5, 0.5}));
  const Rgb plain = at(one, 0.25, 0.26);
  long hatched = 0, inside = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double u = (x + 0.5) / kSize, v = 1 - (y + 0.5) / kSize, slack = 2.0 / kSize;
      const bool is_near = std::min(u, v) > 0.35 - slack && std::max(u, v) < 0.55 + slack;
      const bool is_inside = std::min(u, v) > 0.35 + slack && std::max(u, v) < 0.55 - slack;
      const Rgb colour = both.at(x, y);
      const bool is_usual = colour == kPage || colour == plain || colour == kInk;
      if (colour == kOverlapColour) {
        EXPECT_TRUE(is_near) << x << " " << y;
      }
      hatched += is_inside && !is_usual ? 1 : 0;
      inside += is_inside ? 1 : 0;
    }
  EXPECT_GT(hatched, inside / 4);
  EXPECT_LT(hatched, inside * 7 / 10);
}

TEST(LayoutImage, AFaceThatTheFileRepeatsIsNotHatchedButAFoldIs) {
  TriMesh mesh = grid(4, 4);
  mesh.faces.push_back({mesh.faces[5][1], mesh.faces[5][2], mesh.faces[5][0]});
  EXPECT_EQ(count_of(picture(mesh, flattened(mesh, {0.9, 0.9})), kOverlapColour), 0);
  const TriMesh strip = grid(4, 4);
  UnwrappedSurface folded = flattened(strip, {0.9, 0.9});
  for (Vec2& uv : folded.uv) uv.x() = std::min(uv.x(), 0.9 - uv.x()) * 2;
  EXPECT_GT(count_of(picture(strip, folded), kOverlapColour), kSize * kSize / 10);
}

TEST(LayoutImage, TheLegendShowsEveryColourOfTheScale) {
  const TriMesh mesh = grid(1, 1);
  for (const Colouring colouring :
       {Colouring::stretch, Colouring::angle, Colouring::area, Colouring::flips}) {
    const Image image = picture(mesh, flattened(mesh, {0.5, 0.5}), colouring);
    for (const Swatch& swatch : legend_of(colour_scale(colouring)).swatches) {
      const auto pixel = [](double units) { return static_cast<int>(units * kSize / kPageUnits); };
      EXPECT_EQ(image.at(pixel(swatch.x + swatch.width / 2), pixel(swatch.y + swatch.height / 2)),
                swatch.colour);
    }
  }
}

TEST(LayoutImage, LegendsKeepWithinThePicture) {
  for (const Colouring colouring : {Colouring::stretch, Colouring::area, Colouring::flips}) {
    double right = 0;
    for (const Swatch& swatch : legend_of(colour_scale(colouring)).swatches) {
      EXPECT_GE(swatch.x, right - 1e-6);
      right = swatch.x + swatch.width;
      EXPECT_GE(swatch.y, kPageUnits);
      EXPECT_LE(swatch.y + swatch.height, kPageUnits + kLegendUnits);
    }
    EXPECT_LE(right, kPageUnits);
  }
}

TEST(LayoutImage, IslandsOffThePageAreShownInAGreaterSquare) {
  const TriMesh mesh = grid(2, 2);
  const UnwrappedSurface out = flattened(mesh, {4, 2});
  const Frame frame = frame_of({&out, 1});
  EXPECT_NEAR(frame.side, 4, 1e-12);
  EXPECT_NEAR(frame.corner.y(), -1, 1e-12);
  EXPECT_EQ(frame_of({}).side, 1);
  const Image image = picture(mesh, out);
  EXPECT_NE(at(image, 0.5, 0.5), kPage);
  EXPECT_EQ(at(image, 0.5, 0.05), kPage);
  EXPECT_EQ(at(image, 0.5, 0.95), kPage);
}

TEST(LayoutImage, EveryBoundSizeWorksAndTheSameBytesComeTwice) {
  const TriMesh mesh = sphere_cap(20, 10);
  const Surface surface = surface_of(mesh);
  const UnwrappedSurface out = flattened(mesh, {0.4, 0.4});
  for (const int size : {kMinImageSize, 777}) {
    const Image image = layout_image({&surface, 1}, {&out, 1}, Colouring::angle, size);
    EXPECT_EQ(image.width, size);
    EXPECT_EQ(image.rgb, layout_image({&surface, 1}, {&out, 1}, Colouring::angle, size).rgb);
  }
  EXPECT_EQ(layout_image({}, {}, Colouring::area, kMinImageSize).at(5, 5), kPage);
}

TEST(LayoutImage, HearsAStop) {
  const TriMesh mesh = grid(3, 3);
  const Surface surface = surface_of(mesh);
  const UnwrappedSurface out = flattened(mesh, {1, 1});
  std::stop_source stop;
  stop.request_stop();
  for (const auto& draw : std::vector<std::function<void()>>{
           [&] {
             layout_image({&surface, 1}, {&out, 1}, Colouring::angle, kSize, stop.get_token());
           },
           [&] {
             rasterised({}, {kSize, kSize, kPage}, stop.get_token());
           },
           [&] {
             preview({&surface, 1}, {&out, 1}, kSize, {}, stop.get_token());
           }})
    EXPECT_EQ(error_of(draw).code(), ErrorCode::cancelled);
}

TEST(LayoutImage, WhatIsNotThePageIsPaper) {
  const Image wide = layout_image({}, {}, {Colouring::area, Vec2(1, 0.25)}, kMinImageSize);
  EXPECT_EQ(wide.at(5, 40), kPaper);
  EXPECT_EQ(wide.at(5, 60), kPage);
  const Image high = layout_image({}, {}, {Colouring::area, Vec2(0.5, 1)}, kMinImageSize);
  EXPECT_EQ(high.at(5, 5), kPage);
  EXPECT_EQ(high.at(40, 60), kPaper);
}

}  // namespace
}  // namespace unwrapd::figure
