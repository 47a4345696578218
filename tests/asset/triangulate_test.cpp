// Cutting simple polygons: n - 2 triangles that all turn as the polygon does, and whose areas add
// up to the polygon's, cover it without overlap.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/asset/base/pace.hpp"
#include "core/asset/obj/obj.hpp"

namespace unwrapd::asset::test {
namespace {

using Polygon = std::vector<Vec3>;

double area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a).z() / 2; }

double area(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += area(polygon[0], polygon[i], polygon[i + 1]);
  return sum;
}

void expect_covered(const Polygon& polygon) {
  std::vector<std::array<Index, 3>> triangles;
  Pace pace({});
  obj::triangulate(polygon, triangles, pace);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const auto at = [&](Index corner) { return polygon[static_cast<std::size_t>(corner)]; };
    const double one = area(at(a), at(b), at(c));
    ASSERT_GE(one, 0) << a << ' ' << b << ' ' << c;
    sum += one;
  }
  EXPECT_NEAR(sum, area(polygon), 1e-9 * area(polygon));
}

/// Around the origin, at radii between `inner` and 1.
Polygon star(int points, double inner, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(inner, 1);
  Polygon polygon;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    polygon.push_back(radius(random) * Vec3(std::cos(angle), std::sin(angle), 0));
  }
  return polygon;
}

Polygon regular_star(int points) {
  Polygon polygon = star(points, 1, 0);
  for (std::size_t i = 1; i < polygon.size(); i += 2) polygon[i] /= 2;
  return polygon;
}

/// A band that winds around the origin, along its outer and back along its inner side.
Polygon spiral(int points) {
  Polygon polygon;
  for (int i = 0; i < 2 * points; ++i) {
    const int at = i < points ? i : 2 * points - 1 - i;
    const double angle = 10 * std::numbers::pi * at / points;
    polygon.push_back((angle + (i < points ? 4 : 2)) * Vec3(std::cos(angle), std::sin(angle), 0));
  }
  return polygon;
}

/// Teeth on a bar, each of its own height.
Polygon comb(int teeth) {
  Polygon polygon = {{2.0 * teeth, -1, 0}};
  for (int i = teeth; i-- > 0;) {
    polygon.emplace_back(2 * i + 1.0, 1 + i % 7, 0);
    polygon.emplace_back(2 * i, 0, 0);
  }
  polygon.emplace_back(0, -1, 0);
  return polygon;
}

class Triangulate : public testing::TestWithParam<int> {};

TEST_P(Triangulate, CoversSimplePolygonsOfEveryLength) {
  const int corners = GetParam();
  expect_covered(regular_star(corners));
  for (const unsigned seed : {1U, 2U}) expect_covered(star(corners, .1, seed));
  expect_covered(spiral(corners / 2));
  expect_covered(comb(corners / 2));
}

INSTANTIATE_TEST_SUITE_P(OfLength, Triangulate, testing::Values(8, 100, 512, 514, 1000, 20'000));

}  // namespace
}  // namespace unwrapd::asset::test
