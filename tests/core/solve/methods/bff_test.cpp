// What is bff's own; what it shares with cp and ic is in flattening_test.cpp.
#include "core/solve/methods/bff.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/maps/conformal.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

/// How much the edges of the longest loop are scaled: the greatest factor over the least.
double spread_of_boundary_scales(const Disk& disk, const UvMap& uv) {
  double least = 1e300, greatest = 0;
  for (Index h : disk.loops.front()) {
    const auto a = std::size_t(start_of(disk.faces, h)), b = std::size_t(end_of(disk.faces, h));
    const double scale = (uv[a] - uv[b]).norm() / (disk.positions[a] - disk.positions[b]).norm();
    least = std::min(least, scale), greatest = std::max(greatest, scale);
  }
  return greatest / least;
}

/// Part of an ellipsoid's surface, bounded by a curve without symmetry.
TriMesh lopsided_cap(Index around, Index rings) {
  return shapes::polar_disk(around, rings, shapes::kTurn, [](double r, double phi) {
    const double s = r * (1 + 0.3 * std::cos(phi) + 0.1 * std::sin(3 * phi));
    return Vec3(s * std::cos(phi), 0.7 * s * std::sin(phi), std::sqrt(3 - s * s));
  });
}

TEST(Bff, KeepsTheLengthsOfTheBoundary) {  // up to one scale, and to the order of the edges
  double last = 1e9;
  for (Index rings : {8, 16, 32}) {
    const OwnedDisk d = disk_of(lopsided_cap(6 * rings, rings));
    const double excess = spread_of_boundary_scales(d.disk, bff(d.disk, {}).uv) - 1;
    EXPECT_LT(excess, 0.7 * last) << rings;
    last = excess;
  }
  EXPECT_LT(last, 0.03);
}

TEST(Bff, IsNearlyAsConformalAsTheMapOfLeastConformalEnergy) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(14, seed));
    const Solution s = bff(d.disk, {});
    const UvMap asap = maps::conformal_map(d.disk, Pins::spectral);
    EXPECT_NEAR(s.energy.back(), measure::asap_energy(d.disk.rest, d.disk.faces, s.uv), 1e-12);
    const double angle =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv)).angle;
    const double least =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, asap)).angle;
    EXPECT_LT(angle - 2, 1.2 * (least - 2)) << seed;
  }
}

TEST(Bff, DistortsAreasLessThanTheConformalMapOfTwoPins) {
  const OwnedDisk d = disk_of(lopsided_cap(60, 10));
  const auto area = [&](const UvMap& uv) {
    return measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, uv)).area;
  };
  EXPECT_LT(area(bff(d.disk, {}).uv), area(maps::conformal_map(d.disk, Pins::diameter)));
}

}  // namespace
}  // namespace unwrapd::solve::methods
