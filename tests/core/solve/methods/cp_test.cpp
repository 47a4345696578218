// What is cp's own; what it shares with bff and ic is in flattening_test.cpp.
#include "core/solve/methods/cp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/measure/distortion.hpp"
#include "core/solve/maps/conformal.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

/// 2 pi - the angles about a vertex, by the scalar product in space.
double angle_defect(const Disk& disk, Index vertex) {
  double sum = 0;
  for (const Triangle& face : disk.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      if (face[i] != vertex) continue;
      const Vec3& p = disk.positions[std::size_t(vertex)];
      const Vec3 a = disk.positions[std::size_t(face[(i + 1) % 3])] - p;
      const Vec3 b = disk.positions[std::size_t(face[(i + 2) % 3])] - p;
      sum += std::acos(a.normalized().dot(b.normalized()));
    }
  return 2 * std::numbers::pi - sum;
}

TEST(Cp, StartsFromTheCurvatureOfTheMesh) {
  const OwnedDisk d = disk_of(shapes::cone(20, 6, 0.8));  // all of it at the apex
  EXPECT_NEAR(cp(d.disk, {}).energy.front(), angle_defect(d.disk, 0), 1e-9);
}

TEST(Cp, LeavesLessCurvatureTheFinerTheMesh) {  // exact to first order in the scale factors
  double last = 1e9;
  for (Index rings : {4, 8, 16, 32}) {
    const OwnedDisk d = disk_of(shapes::sphere_cap(6 * rings, rings));
    const Solution s = cp(d.disk, {});
    ASSERT_EQ(s.energy.size(), 2U);
    EXPECT_LT(s.energy.back(), 0.05 * s.energy.front()) << rings;
    EXPECT_LT(s.energy.back(), last / 2) << rings;
    last = s.energy.back();
  }
}

TEST(Cp, IsNoWorseThanAsapWhereTheScalesWouldBreakTriangles) {  // steep cones
  for (Index around : {6, 8, 24})
    for (double height : {2.0, 5.0, 12.0}) {
      const OwnedDisk d = disk_of(shapes::cone(around, 8, height));
      const auto angle = [&](const UvMap& uv) {
        return measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, uv)).angle;
      };
      EXPECT_LT(angle(cp(d.disk, {}).uv), 1.1 * angle(maps::conformal_map(d.disk, Pins::diameter)))
          << around << ' ' << height;
    }
}

}  // namespace
}  // namespace unwrapd::solve::methods
