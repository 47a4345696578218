#include "core/figure/layout_svg.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/core/figure/laid_out.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::figure {
namespace {

using namespace shapes;

/// The map (x, y) -> (x, y) after `stretch` along x: of a flat mesh its layout.
UnwrappedSurface flattened(const TriMesh& mesh, double stretch = 1) {
  return laid_out(mesh, [&](const Vec3& p) { return Vec2(stretch * p.x(), p.y()); });
}

std::string picture(const TriMesh& mesh, const UnwrappedSurface& out) {
  const Surface surface = surface_of(mesh);
  return layout_svg({&surface, 1}, {&out, 1});
}

/// The data of every path, in order.
std::vector<std::string> path_data(const std::string& svg) {
  std::vector<std::string> paths;
  for (std::size_t at = svg.find("<path"); at != std::string::npos;
       at = svg.find("<path", at + 1)) {
    const std::size_t from = svg.find(" d=\"", at) + 4;
    paths.push_back(svg.substr(from, svg.find('"', from) - from));
  }
  return paths;
}

long count(const std::string& text, char c) { return std::count(text.begin(), text.end(), c); }

/// Twice the signed area of all triangles of a path, in whole units: reads it back as SVG means it.
long twice_area(const std::string& path) {
  long sum = 0;
  const char* p = path.c_str();
  const auto number = [&p] {
    char* end = nullptr;
    const long n = std::strtol(p, &end, 10);
    p = end;
    return n;
  };
  while (*p == 'M') {
    ++p, number(), number();
    ++p;
    const long ax = number(), ay = number();
    ++p;
    const long bx = number(), by = number();
    ++p;
    sum += ax * by - ay * bx;
  }
  EXPECT_EQ(*p, '\0');
  return sum;
}

TEST(LayoutSvg, AnIsometryHasOneColourAndItsBoundary) {
  const TriMesh mesh = grid(4, 3);
  const auto paths = path_data(picture(mesh, flattened(mesh)));
  ASSERT_EQ(paths.size(), 2U);
  EXPECT_EQ(count(paths[0], 'M'), 24);
  EXPECT_NEAR(double(twice_area(paths[0])), 2.0 * 40960 * 40960, 1);
  EXPECT_EQ(count(paths[1], 'M'), 14);
}

TEST(LayoutSvg, SeveralPagesHaveBorders) {
  const TriMesh mesh = merged(std::array{grid(1, 1), moved(grid(1, 1), {2, 0, 0})});
  UnwrappedSurface out = flattened(mesh, 0.5);
  const Surface surface = surface_of(mesh);
  LayoutLook look;
  const auto borders = [&] {
    return count(path_data(layout_svg({&surface, 1}, {&out, 1}, look)).back(), 'M') - 8;
  };
  EXPECT_EQ(borders(), 0);
  look.page_count = 2;
  EXPECT_EQ(borders(), 8);
  const std::string outer = path_data(layout_svg({&surface, 1}, {&out, 1}, look)).back();
  EXPECT_NE(outer.find("M40960 10240l0 20480"), std::string::npos) << outer;  // right side of 2
  look.is_cropped = true;
  EXPECT_EQ(borders(), 0);
}

TEST(LayoutSvg, AFlippedTriangleIsInThePathOnTop) {
  TriMesh mesh = grid(2, 2);
  UnwrappedSurface out = flattened(mesh);
  std::swap(out.faces[3][0], out.faces[3][1]);
  const std::string svg = picture(mesh, out);
  const auto paths = path_data(svg);
  const std::string& flipped = paths[paths.size() - 2];
  EXPECT_EQ(count(flipped, 'M'), 1);
  EXPECT_LT(twice_area(flipped), 0);
  EXPECT_NE(svg.find("#ff2a4d"), std::string::npos);
}

TEST(LayoutSvg, PlacesThatTwoTrianglesShareAreHatched) {
  const TriMesh mesh = merged(std::array{grid(1, 1), moved(grid(1, 1), {2, 0, 0})});
  UnwrappedSurface out = flattened(mesh);
  for (Vec2& uv : out.uv) uv *= 0.25;
  EXPECT_EQ(picture(mesh, out).find("shared"), std::string::npos);
  for (std::size_t v = 4; v < 8; ++v) out.uv[v] = out.uv[v - 4] + Vec2(0.1, 0.1);
  const std::string svg = picture(mesh, out);
  const auto paths = path_data(svg);
  EXPECT_NE(svg.find("url(#shared)"), std::string::npos);
  double area = 0;  // of polygons, each "Mx yLx yLx yz"
  const std::string& hatched = paths[paths.size() - 2];
  std::vector<std::array<double, 2>> polygon;
  const auto number = [&](std::size_t& i) {
    std::size_t read = 0;
    const double value = std::stod(hatched.substr(i), &read);
    i += read;
    return value;
  };
  for (std::size_t i = 0; i < hatched.size();) {
    if (hatched[i++] == 'z') {
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const auto& [x, y] = polygon[k];
        const auto& [next_x, next_y] = polygon[(k + 1) % polygon.size()];
        area += (x * next_y - y * next_x) / 2;
      }
      polygon.clear();
      continue;
    }
    const double x = number(i);
    polygon.push_back({x, number(i)});
  }
  EXPECT_NEAR(area / 40960 / 40960, 0.15 * 0.15, 1e-4);
}

TEST(LayoutSvg, MoreDistortionIsALaterColour) {
  TriMesh mesh = merged(std::array{grid(1, 1), moved(grid(1, 1), {2, 0, 0})});
  UnwrappedSurface out = flattened(mesh);
  for (std::size_t v = 0; v < 4; ++v) out.uv[v] *= 0.1;
  for (std::size_t v = 4; v < 8; ++v) out.uv[v] = {0.2 + 0.02 * out.uv[v].x(), 0.5 * out.uv[v].y()};
  const auto paths = path_data(picture(mesh, out));
  ASSERT_EQ(paths.size(), 3U);  // both have the same area: only the second is distorted
  EXPECT_NEAR(double(twice_area(paths[0])), double(twice_area(paths[1])), 1e5);
  EXPECT_EQ(paths[0].find("M0 0"), 0U) << paths[0];
}

TEST(LayoutSvg, VerticesSplitWithoutASeamMakeNoBoundary) {
  const TriMesh mesh = soup(grid(3, 3));
  const auto paths = path_data(picture(mesh, flattened(mesh)));
  EXPECT_EQ(count(paths.back(), 'M'), 12);
}

TEST(LayoutSvg, FacesWithoutAreaAreLeftOut) {
  TriMesh mesh = grid(1, 1);
  mesh.faces.push_back({0, 0, 1});
  EXPECT_EQ(count(path_data(picture(mesh, flattened(mesh)))[0], 'M'), 2);
}

TEST(LayoutSvg, AnEmptyPageIsStillADocument) {
  const std::string svg = layout_svg({}, {});
  EXPECT_EQ(svg.find("<svg "), 0U);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST(LayoutSvg, AWidePageIsTheLowerPartOfTheSquare) {
  const Surface surface = surface_of(grid(2, 2));
  UnwrappedSurface out = flattened(surface.mesh);
  for (Vec2& uv : out.uv) uv = uv.cwiseProduct(Vec2(1, 0.25)) / 2;
  const std::string svg = layout_svg({&surface, 1}, {&out, 1}, {Colouring::angle, Vec2(1, 0.25)});
  EXPECT_NE(svg.find("<rect y=\"3072\" width=\"4096\" height=\"1024\""), std::string::npos);
  EXPECT_EQ(layout_svg({&surface, 1}, {&out, 1}).find("<rect y="), std::string::npos);
}

}  // namespace
}  // namespace unwrapd::figure
