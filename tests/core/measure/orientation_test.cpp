#include "core/measure/orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/shapes.hpp"

namespace unwrapd::measure {
namespace {

__extension__ using Wide = __int128;

/// Points of a lattice of 2^-53, far from the origin or near: as integers the sign is certain.
struct LatticePoint {
  std::int64_t x, y;
  [[nodiscard]] Vec2 point() const {
    return {std::ldexp(double(x), -53), std::ldexp(double(y), -53)};
  }
};

int sign_by_integers(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  const Wide d = Wide(a.x - c.x) * (b.y - c.y) - Wide(a.y - c.y) * (b.x - c.x);
  return d > 0 ? 1 : d < 0 ? -1 : 0;
}

TEST(Orientation, AgreesWithIntegersOnNearlyCollinearPoints) {
  std::mt19937_64 rng(1);
  std::uniform_int_distribution<std::int64_t> any(0, (std::int64_t(1) << 53) - 1), few(-3, 3);
  int zeros = 0, signs = 0;
  for (int k = 0; k < 200000; ++k) {
    const LatticePoint a{any(rng), any(rng)}, b{any(rng), any(rng)};
    const double s = double(any(rng)) * 0x1p-53;
    const LatticePoint c{a.x + std::int64_t(s * double(b.x - a.x)) + few(rng),
                         a.y + std::int64_t(s * double(b.y - a.y)) + few(rng)};
    const int expected = sign_by_integers(a, b, c);
    (expected == 0 ? zeros : signs) += 1;
    ASSERT_EQ(orientation(a.point(), b.point(), c.point()), expected) << k;
  }
  EXPECT_GT(signs, 100000);
}

TEST(Orientation, IsZeroOnlyForPointsOnOneLine) {
  for (double x : {1.0, 0.1, 1e-100, 3e7}) {
    const Vec2 a(x, x), b(2 * x, 2 * x), c(8 * x, 8 * x);
    EXPECT_EQ(orientation(a, b, c), 0);
    const Vec2 above(8 * x, std::nextafter(8 * x, 1e300)), below(8 * x, std::nextafter(8 * x, 0));
    EXPECT_EQ(orientation(a, b, above), 1);
    EXPECT_EQ(orientation(a, b, below), -1);
  }
}

TEST(Orientation, CoordinatesOfVeryDifferentSizeKeepTheirDigits) {
  // (1e17, 1e17) + (tiny, 0): the difference to the others is not a double
  const Vec2 a(1e17, 1e17), b(0, 0), above(1e-17, 2e-17), below(2e-17, 1e-17);
  EXPECT_EQ(orientation(b, a, above), 1);
  EXPECT_EQ(orientation(b, a, below), -1);
  EXPECT_EQ(orientation(a, above, b), 1);
  EXPECT_EQ(orientation(above, b, a), 1);
}

TEST(Orientation, TurnsWithTheOrderOfItsPoints) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> at(0.5, 0.5 + 1e-14);
  for (int k = 0; k < 20000; ++k) {
    const Vec2 a(at(rng), at(rng)), b(at(rng), at(rng)), c(12, 12);
    const int sign = orientation(a, b, c);
    ASSERT_EQ(orientation(b, c, a), sign);
    ASSERT_EQ(orientation(c, a, b), sign);
    ASSERT_EQ(orientation(b, a, c), -sign);
    ASSERT_EQ(orientation(a, a, c), 0);
  }
}

TEST(Orientation, FindsEveryFlippedOrCollapsedFace) {
  const TriMesh mesh = shapes::grid(4, 4);
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(p.x(), p.y());
  EXPECT_TRUE(flipped_faces(mesh.faces, uv).empty());
  uv[12] += Vec2(0.25, 0);  // onto its neighbour: one edge of no length
  std::vector<Index> expected;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    const auto& [a, b, c] = mesh.faces[t];
    const Vec2 u = uv[std::size_t(b)] - uv[std::size_t(a)],
               w = uv[std::size_t(c)] - uv[std::size_t(a)];
    if (u.x() * w.y() - u.y() * w.x() <= 0) expected.push_back(Index(t));
  }
  EXPECT_EQ(flipped_faces(mesh.faces, uv), expected);
  EXPECT_GE(expected.size(), 2U);
}

}  // namespace
}  // namespace unwrapd::measure
