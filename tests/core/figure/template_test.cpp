// A template to paint on: the page alone, in its own pixels, transparent, with edges and numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/figure/island_numbers.hpp"
#include "core/figure/layout_image.hpp"
#include "core/figure/layout_svg.hpp"
#include "core/figure/painting.hpp"
#include "tests/core/figure/laid_out.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::figure {
namespace {

using namespace shapes;

constexpr int kPageSide = 256;

/// Separate squares of two triangles each, `count` in a row, a tenth of the page wide.
UnwrappedSurface squares(int count) {
  UnwrappedSurface out;
  for (int k = 0; k < count; ++k) {
    const double x = 0.03 + 0.12 * k;
    const auto first = static_cast<Index>(out.uv.size());
    for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)})
      out.uv.emplace_back(Vec2(x, 0.2) + 0.1 * corner);
    out.faces.push_back({first, first + 1, first + 2});
    out.faces.push_back({first, first + 2, first + 3});
  }
  for (Index v = 0; v < static_cast<Index>(out.uv.size()); ++v) out.source.push_back(v);
  return out;
}

/// The mesh that such a map lies flat on.
Surface flat(const UnwrappedSurface& out) {
  TriMesh mesh;
  mesh.faces = out.faces;
  for (const Vec2& uv : out.uv) mesh.positions.emplace_back(uv.x(), uv.y(), 0);
  return surface_of(mesh);
}

Image drawn(const UnwrappedSurface& out, const LayoutLook& look, int size = kPageSide) {
  const Surface surface = flat(out);
  return layout_image({&surface, 1}, {&out, 1}, look, size);
}

std::string written(const UnwrappedSurface& out, const LayoutLook& look) {
  const Surface surface = flat(out);
  return layout_svg({&surface, 1}, {&out, 1}, look);
}

LayoutLook template_of(const Vec2& page = Vec2::Ones()) {
  LayoutLook look(Colouring::stretch, page);
  look.legend = look.background = false;
  look.wireframe = look.is_cropped = true;
  return look;
}

std::uint8_t alpha_at(const Image& image, double u, double v) {
  const auto x = static_cast<std::size_t>(u * image.width);
  const auto y = static_cast<std::size_t>((1 - v) * image.height);
  return image.alpha[y * static_cast<std::size_t>(image.width) + x];
}

TEST(Template, HasThePixelsOfThePageAndIsTransparentButForEdges) {
  const Image image = drawn(squares(3), template_of());
  EXPECT_EQ(image.width, kPageSide);
  EXPECT_EQ(image.height, kPageSide);
  ASSERT_EQ(image.alpha.size(), std::size_t{kPageSide} * kPageSide);
  EXPECT_EQ(alpha_at(image, 0.5, 0.8), 0) << "beside the islands";
  EXPECT_EQ(alpha_at(image, 0.03 + 0.07, 0.2 + 0.03), 0) << "within a triangle";
  EXPECT_GT(alpha_at(image, 0.03 + 0.05, 0.2 + 0.05), 50) << "on the diagonal";
  EXPECT_GT(alpha_at(image, 0.03 + 0.05, 0.2), 50) << "on the outline";
  const Image high = drawn(squares(3), template_of({0.5, 1}));
  EXPECT_EQ(high.width, kPageSide / 2);
  EXPECT_EQ(high.height, kPageSide);
  EXPECT_EQ(drawn(squares(1), template_of({1, 0.5}), 10).height, 5) << "a page of few texels";
}

/// Where nothing is transparent, the page is a part of the picture of the whole square.
TEST(Template, IsWhatTheWholePictureShowsOfThePage) {
  for (const Vec2& page : {Vec2(1, 0.5), Vec2(0.5, 1), Vec2(1, 1)}) {
    LayoutLook look(Colouring::area, page);
    look.legend = false;
    const Image whole = drawn(squares(4), look);
    look.is_cropped = true;
    const Image part = drawn(squares(4), look);
    EXPECT_EQ(part.height, kPageSide * page.y());
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x)
        ASSERT_EQ(part.at(x, y), whole.at(x, whole.height - part.height + y)) << x << ' ' << y;
  }
}

/// Laid over the page's grey, a transparent picture is the opaque one.
TEST(Template, LaidOverItsBackgroundIsTheOpaquePicture) {
  const TriMesh mesh = sphere_cap(10, 6);
  const Surface surface = surface_of(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.05, 0.95);
  const UnwrappedSurface out =
      laid_out(mesh, [&](const Vec3&) {  // tangled: all that can be drawn is
        const double u = place(random);
        return Vec2(u, place(random));
      });
  LayoutLook look(Colouring::flips);
  look.numbers = true;
  const Image opaque = layout_image({&surface, 1}, {&out, 1}, look, kPageSide);
  look.background = false;
  const Image clear = layout_image({&surface, 1}, {&out, 1}, look, kPageSide);
  for (std::size_t k = 0; k < clear.alpha.size(); ++k)
    for (std::size_t part = 0; part < 3; ++part) {
      const double share = clear.alpha[k] / 255.0;
      const double over = share * clear.rgb[3 * k + part] + (1 - share) * kPage[part];
      ASSERT_NEAR(over, opaque.rgb[3 * k + part], 2) << k;
    }
}

TEST(Template, WhatLiesBeyondThePageIsCutOff) {
  UnwrappedSurface out = squares(1);
  for (Vec2& uv : out.uv) uv += Vec2(1, 0);  // on the next page
  const Image image = drawn(out, template_of());
  EXPECT_EQ(std::ranges::count(image.alpha, 0), std::ssize(image.alpha));
}

TEST(Template, EdgesAreThoseWithinIslandsAndTheirOutlinesEachOnce) {
  const TriMesh mesh = grid(6, 4);
  const UnwrappedSurface out = by_xy(mesh);
  const auto faces = std::ssize(mesh.faces);
  const auto ends = std::ssize(outline(out)), inner = std::ssize(inner_edges(out));
  EXPECT_EQ(ends + 2 * inner, 3 * faces);
  EXPECT_EQ(mesh.vertex_count() - (ends + inner) + faces, 1) << "Euler, of a disk";
}

TEST(Template, NumbersIslandsInTheOrderOfTheirFacesAndInsideOfThem) {
  const UnwrappedSurface out = squares(8);
  const std::vector<UnwrappedSurface> both = {out, squares(2)};
  const std::vector<IslandMark> marks = island_marks(both);
  ASSERT_EQ(marks.size(), 10U);
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const Vec2 off = (marks[k].middle - Vec2(0.03 + 0.12 * static_cast<double>(k % 8), 0.2)) / 0.1;
    EXPECT_TRUE(off.minCoeff() > 0 && off.maxCoeff() < 1) << k;
    EXPECT_GT(marks[k].size, 0);
  }
}

TEST(Template, ANumberStandsInItsIslandHoweverItIsBent) {
  UnwrappedSurface ring;  // its middle is in none of its faces
  constexpr int kSteps = 40;
  for (int k = 0; k < kSteps; ++k)
    for (const double radius : {0.3, 0.4}) {
      const double angle = 6.283 * k / kSteps;
      ring.source.push_back(static_cast<Index>(ring.uv.size()));
      ring.uv.emplace_back(0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle));
    }
  for (Index k = 0; k + 1 < kSteps; ++k) {
    ring.faces.push_back({2 * k, 2 * k + 1, 2 * k + 3});
    ring.faces.push_back({2 * k, 2 * k + 3, 2 * k + 2});
  }
  const std::vector<IslandMark> marks = island_marks({&ring, 1});
  ASSERT_EQ(marks.size(), 1U);
  const double radius = (marks[0].middle - Vec2(0.5, 0.5)).norm();
  EXPECT_TRUE(radius > 0.3 && radius < 0.4) << radius;
}

TEST(Template, NumbersAreDrawnInTheIslandsAndNowhereElse) {
  LayoutLook look = template_of();
  const Image bare = drawn(squares(8), look, 1024);
  look.numbers = true;
  const Image numbered = drawn(squares(8), look, 1024);
  std::set<int> islands;
  for (int y = 0; y < 1024; ++y)
    for (int x = 0; x < 1024; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * 1024 + static_cast<std::size_t>(x);
      if (bare.alpha[k] == numbered.alpha[k]) continue;
      const double u = x / 1024.0, v = 1 - y / 1024.0;
      ASSERT_TRUE(v > 0.19 && v < 0.31) << v;
      islands.insert(static_cast<int>((u - 0.03) / 0.12));
    }
  EXPECT_EQ(islands.size(), 8U);
}

TEST(Template, AsADrawingHasTheSameParts) {
  LayoutLook look = template_of({1, 0.25});
  look.numbers = true;
  const std::string svg = written(squares(5), look);
  EXPECT_NE(svg.find("viewBox=\"0 3072 4096 1024\""), std::string::npos);
  EXPECT_EQ(svg.find("<rect"), std::string::npos) << "no background, no legend";
  EXPECT_EQ(svg.find("fill=\"#c"), std::string::npos);
  for (int k = 1; k <= 5; ++k)
    EXPECT_NE(svg.find(">" + std::to_string(k) + "</text>"), std::string::npos) << k;
  EXPECT_EQ(svg.find(">6</text>"), std::string::npos);
  const std::size_t wires = svg.find(hex(kWire));
  ASSERT_NE(wires, std::string::npos);
  const std::string path = svg.substr(wires, svg.find("/>", wires) - wires);
  EXPECT_EQ(std::ranges::count(path, 'M'), 5) << "the diagonals";
}

TEST(Template, ACroppedLegendIsAsWideAsThePage) {
  LayoutLook look(Colouring::area, Vec2(0.5, 1));
  look.is_cropped = true;
  EXPECT_EQ(drawn(squares(1), look).height, kPageSide + 10);
  EXPECT_EQ(drawn(squares(1), look).width, kPageSide / 2);
  const std::string svg = written(squares(1), look);
  EXPECT_NE(svg.find("viewBox=\"0 0 2048 4256\""), std::string::npos);
  EXPECT_NE(svg.find("scale(2048)"), std::string::npos);
}

}  // namespace
}  // namespace unwrapd::figure
